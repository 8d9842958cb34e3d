// Takes the strokes of all clients of a session, and sends each the edits of the others.
#pragma once

#include <map>
#include <vector>

#include "engine/core/clock.hpp"
#include "engine/core/log.hpp"
#include "haptics/sharing/messages.hpp"
#include "haptics/sharing/shared_points.hpp"
#include "haptics/sharing/stroke_journal.hpp"

namespace palpate::sharing {

struct StrokeTally {
  std::uint64_t pieces = 0, states = 0;  ///< of strokes, taken, including those in the journal
  std::uint64_t again = 0;               ///< duplicates, and pieces received too early
  std::uint64_t refused = 0;             ///< invalid pieces, and followers beyond the maximum
  std::uint64_t sent = 0;                ///< states, to all clients together
  std::uint64_t sculptors = 0;           ///< clients of which at least one piece was taken
};

class StrokeServer {
 public:
  struct Parts {
    const Participant& participant;
    const Topics& topics;
    Id session;
    SharedPoints& points;
    StrokeJournal* journal = nullptr;  ///< has each piece before its client is notified; may be null
    Log* log = nullptr;                ///< logs new clients
  };
  /// All that `parts` refers to must outlive it.
  explicit StrokeServer(const Parts& parts);
  void attach(ReaderWait& wait) const;
  /// Processes what was received. Throws FileError for the journal.
  void take();
  /// That client, which may be a follower, was heard.
  void heard(const Id& client);
  /// Sends what is due, as far as the links accept it. Returns the seconds until there is more to do.
  double write();
  const StrokeTally& counts() const { return counts_; }

 private:
  // A client that receives the edits of others.
  struct Follower {
    Writer<Result> results;  // in its partition
    std::uint32_t epoch = 0;
    std::uint64_t counter = 0, toldAcked = 0;
    SharedPoints::Place place;
    Result next{};              // as it was when its states were collected
    std::vector<State> states;  // of `next`
    bool holds = false;         // `next` is still to be written
    std::uint32_t unacked = 0;  // results written since all were acknowledged; an upper bound
    Stopwatch lastHeard, lastWritten;
  };
  void take(const Stroke& stroke);
  void take(const ResumeRequest& request);
  double write(const Id& client, Follower& follower);
  bool writeOne(const Id& client, Follower& follower);

  Parts parts_;
  Reader<Stroke> strokes_;
  Reader<ResumeRequest> resumes_;
  std::map<Id, Follower> followers_;
  std::vector<PointState> states_;
  StrokeTally counts_;
};

}  // namespace palpate::sharing
