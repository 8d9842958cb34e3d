// A recorded session once more: its model, its edits, and all of it run again in virtual time and held against the
// record.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "haptics/session/backends.hpp"
#include "haptics/session/replay_comparison.hpp"
#include "haptics/session/session_header.hpp"

namespace palpate {

/// What a replay needs beside the log. All of it outlives the replay.
struct ReplayParts {
  const Backends& backends;
  Log& log;
  unsigned threads = 0;               ///< on the CPU; 0: one per core
  std::string model;                  ///< file in place of the one that the log names; empty: that one
  const PointCloud* cloud = nullptr;  ///< in place of any file
  std::string naming = "model";       ///< what a person names a model with, in the words of errors
};

/// A log, the model that it is about, until it is run again, and the points as its edits leave them.
struct Recorded {
  std::string file;
  SessionRecord record;
  RecordedSession session;
  Model model;
  ModelScale scale;
  std::vector<PointState> points;
  std::optional<bool> endsAsRecorded;  ///< nothing where the session did not come to its end
};
/// Throws FileError for a log that cannot be read or is damaged beyond use, and for another model than the session had.
Recorded loadRecorded(const std::string& log, const ReplayParts& parts);

/// The session run again in virtual time.
struct SessionAgain {
  ServoResult result;
  std::vector<LoggedTick> ticks;
  EditBatch edits;
  std::vector<PointState> points;
};
/// Takes the model. Throws FileError where there is no tick, and Error.
SessionAgain runAgain(Recorded& recorded, const ReplayParts& parts);

struct ReplayOutcome {
  ComparableTicks comparable;
  Differences differences;

  /// All ticks and all points in the end came out the same, to the last bit where the tolerance was 0.
  bool isWhole(const Recorded& recorded) const {
    return !differences.any() && differences.ends && differences.ticks == recorded.record.ticks.size();
  }
};
/// `tolerance`: N for forces and mm for points; 0: the same bits.
ReplayOutcome compareRuns(const Recorded& recorded, const SessionAgain& again, double tolerance);

}  // namespace palpate
