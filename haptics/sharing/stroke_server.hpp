// Takes the strokes of all clients of a session.
#pragma once

#include <vector>

#include "engine/core/log.hpp"
#include "haptics/sharing/messages.hpp"
#include "haptics/sharing/shared_points.hpp"
#include "haptics/sharing/stroke_journal.hpp"

namespace palpate::sharing {

struct StrokeTally {
  std::uint64_t pieces = 0, states = 0;  ///< of strokes, taken, including those in the journal
  std::uint64_t again = 0;               ///< duplicates, and pieces received too early
  std::uint64_t refused = 0;             ///< invalid pieces
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
    Log* log = nullptr;                ///< logs the first refused piece
  };
  /// All that `parts` refers to must outlive it.
  explicit StrokeServer(const Parts& parts);
  void attach(ReaderWait& wait) const { wait.attach(strokes_); }
  /// Processes what was received. Throws FileError for the journal.
  void take();
  const StrokeTally& counts() const { return counts_; }

 private:
  void take(const Stroke& stroke);

  Parts parts_;
  Reader<Stroke> strokes_;
  std::vector<PointState> states_;
  StrokeTally counts_;
};

}  // namespace palpate::sharing
