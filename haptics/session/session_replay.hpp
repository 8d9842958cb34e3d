// Replay of a recorded session: loads its model and edits, runs it again in virtual time, and compares both runs.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/edit/layer_attributes.hpp"
#include "haptics/session/backends.hpp"
#include "haptics/session/replay_comparison.hpp"
#include "haptics/session/session_header.hpp"

namespace palpate {

/// Arguments of a replay beside the log. All pointees must outlive it.
struct ReplayParts {
  const Backends& backends;
  Log& log;
  unsigned threads = 0;               ///< on the CPU; 0: one per core
  std::string model;                  ///< file in place of the one in the log; empty: that one
  const PointCloud* cloud = nullptr;  ///< in place of any file
  std::string naming = "model";       ///< name of the option for the model, for errors
};

/// A log, its model (until it is run again), and the points, masks and fields after its edits.
struct Recorded {
  std::string file;
  SessionRecord record;
  RecordedSession session;
  Model model;
  ModelScale scale;
  std::vector<PointState> points;
  LayerAttributes attributes;          ///< of these
  std::optional<bool> endsAsRecorded;  ///< empty if the session was interrupted
};
/// Throws FileError for a log that cannot be read or is damaged beyond use, and for another model than the session's.
Recorded loadRecorded(const std::string& log, const ReplayParts& parts);

/// A replay in virtual time.
struct SessionAgain {
  ServoResult result;
  std::vector<LoggedTick> ticks;
  EditBatch edits;
  std::vector<PointState> points;
  LayerAttributes attributes;
};
/// Moves the model out of `recorded`. Throws FileError if there is no tick, and Error.
SessionAgain runAgain(Recorded& recorded, const ReplayParts& parts);

struct ReplayOutcome {
  ComparableTicks comparable;
  Differences differences;

  /// All ticks, and the points, masks and fields at the end, are the same, bit by bit if the tolerance was 0.
  bool isWhole(const Recorded& recorded) const {
    return !differences.any() && differences.ends && differences.ticks == recorded.record.ticks.size();
  }
};
/// Why not all ticks, or not the points at the end, were compared; empty if all were.
std::string reasonOf(const ReplayOutcome& outcome, const Recorded& recorded);
/// `tolerance`: N for forces and mm for points; 0: the same bits.
ReplayOutcome compareRuns(const Recorded& recorded, const SessionAgain& again, double tolerance);

}  // namespace palpate
