// Takes the strokes of all who have joined a session, and tells each what the others do.
#pragma once

#include <map>
#include <vector>

#include "engine/core/clock.hpp"
#include "engine/core/log.hpp"
#include "haptics/sharing/early_copies.hpp"
#include "haptics/sharing/messages.hpp"
#include "haptics/sharing/sample_copies.hpp"
#include "haptics/sharing/shared_points.hpp"
#include "haptics/sharing/stroke_journal.hpp"

namespace palpate::sharing {

struct StrokeTally {
  std::uint64_t pieces = 0, states = 0;  ///< of strokes, that were taken; those in the journal included
  std::uint64_t copied = 0;              ///< of the pieces, whose copy came before they did
  std::uint64_t again = 0;               ///< that the reliable way brought before, or too early
  std::uint64_t refused = 0;             ///< that no client of ours makes; and who would follow and has no room
  std::uint64_t sent = 0;                ///< states, to all clients together
  std::uint64_t sculptors = 0;           ///< clients that have ever sent a piece that was taken
};

class StrokeServer {
 public:
  struct Parts {
    const Participant& participant;
    const Topics& topics;
    Id session;
    SharedPoints& points;
    StrokeJournal* journal = nullptr;  ///< has each piece before its client hears of it; may be null
    Log* log = nullptr;                ///< hears of who comes
  };
  /// All that `parts` refers to outlives it.
  explicit StrokeServer(const Parts& parts);
  void attach(ReaderWait& wait) const;
  /// What has come. Throws FileError of the journal.
  void take();
  /// Somebody who may be one of those who follow is there.
  void heard(const Id& client);
  /// What is due, as far as the links take it; so many seconds later there is more to do.
  double write();
  const StrokeTally& counts() const { return counts_; }

 private:
  // Somebody who hears of the others.
  struct Follower {
    Writer<Result> results;  // in its partition
    std::uint32_t epoch = 0;
    std::uint64_t counter = 0, toldAcked = 0;
    SharedPoints::Place place;
    Result next{};              // as it was when its states were collected
    std::vector<State> states;  // of it
    bool holds = false;         // it is to be written
    std::uint32_t unacked = 0;  // results that were written since all had come, at most
    SampleCopies<Result> copies;
    EarlyCopies<std::vector<PointState>> early;  // pieces of its own
    Stopwatch lastHeard, lastWritten;
  };
  enum class Way { reliable, copy };
  void take(const Stroke& stroke, Way way);
  SharedPoints::Taken take(const Id& client, std::uint64_t number, std::span<const PointState> states, Way way);
  void count(const Id& client, std::uint64_t number, Way way, SharedPoints::Taken taken);
  void take(const ResumeRequest& request);
  double write(const Id& client, Follower& follower);
  double writeResults(const Id& client, Follower& follower);
  bool writeOne(const Id& client, Follower& follower);

  Parts parts_;
  Reader<Stroke> strokes_, strokeCopies_;
  Reader<ResumeRequest> resumes_;
  std::map<Id, Follower> followers_;
  std::map<Id, std::uint64_t> reliable_;  // by client, the last piece that has come the reliable way
  std::vector<PointState> states_;
  StrokeTally counts_;
};

}  // namespace palpate::sharing
