#pragma once

#include "apps/cli/model.hpp"
#include "apps/cli/sharing_results.hpp"
#include "engine/cloud/length_unit.hpp"
#include "engine/contact/surface.hpp"
#include "engine/motion/depth_player.hpp"
#include "engine/motion/rigid_motion.hpp"
#include "engine/touch/touch_backend.hpp"
#include "haptics/servo_loop.hpp"
#include "haptics/session/edit_relay.hpp"
#include "haptics/sharing/ros.hpp"
#include "haptics/trajectory.hpp"

namespace palpate {

/// Maximum distance of the proxy from the surface computed on the CPU in double precision, over up to 200 fresh ticks
/// in contact before the first edit. For a moving model, in its rest position.
struct ContactError {
  double worst_mm = 0;
  std::size_t ticks = 0;      ///< evaluated ones
  std::size_t undefined = 0;  ///< of them, without a surface in double precision
};
ContactError contactError(const Trace& trace, const Model& model, const SurfaceOptions& surface,
                          std::optional<double> firstEditTime_s, const std::optional<RigidMotion>& motion);

/// Describes the updates of the index after its first build.
std::string_view nameOf(const IndexWork& index);

/// Counts of the servo loop beside the trace.
struct ServoReport {
  TickHistogram step_us, late_us;
  SchedulingStatistics scheduling;
  GateCounts withheld;
  std::optional<double> leastEnergy_mJ;
};
ServoReport servoReport(const ServoResult& result);

/// The completed session log.
struct LogReport {
  std::uint64_t bytes = 0, lostTicks = 0, mergedEdits = 0;
};

/// Result of a hand after the first.
struct FurtherHandReport {
  std::string device;
  TraceSummary trace;
  HandCounts counts;
};

/// The simulated matter.
struct MatterReport {
  SceneReport scene;
  bool isSoft = false;
  double dropped_s = 0;                ///< by which it fell behind the clock
  std::uint64_t advances = 0;          ///< number of advances, each by some milliseconds at once
  double duration_s = 0;               ///< of the session
  SurfaceHolds holds = {};             ///< of a soft body
  std::vector<PortEnergy> ports = {};  ///< of each hand
};

/// A stage between the beginning of the command and the first answer, and its duration.
struct StartStage {
  std::string_view name;
  double time_s = 0;
};

/// Result of a touch session.
struct TouchReport {
  std::size_t points = 0;
  std::string backend, machine, method;
  double build_us = 0;
  std::vector<StartStage> start;
  TraceSummary trace;
  ServoReport servo;
  Summary edit_us, bridge_us;
  TouchShortfalls shortfalls;
  std::uint64_t compactions = 0;
  IndexWork index;
  std::size_t movedPoints = 0;  ///< that are edited (SculptedCloud::edited)
  BlockedMoves blocked;
  bool realtimePriority = false;
  bool pacedByDevice = false;
  bool realtime = false;
  bool interrupted = false;
  bool edits = false;
  double stiffness_N_per_mm = 0;
  double radius_mm = 0, cell_mm = 0, spacing_mm = 0, noise_spacings = 0, mm_per_unit = 1;
  double longestSide = 0;  ///< model units
  LengthUnit unit = LengthUnit::unknown;
  std::string tool;
  std::size_t toolPoints = 0;  ///< 0: the HIP is the only point
  ContactError error;
  std::optional<PlayCounts> frames;    ///< if the model is a depth camera
  std::optional<MatterReport> matter;  ///< if the model is a scene
  std::optional<StrokeCounts> shape;   ///< of a soft body with a brush
  std::optional<UndoneStrokes> back;   ///< if undo was requested
  std::optional<RosHand::Counts> ros;  ///< if it is published for ROS
  std::optional<SharedCounts> shared;  ///< if others feel and sculpt it, too
  std::optional<ServerSave> atServer;  ///< answer of their server to --save
  std::optional<std::size_t> cameras;  ///< of the other participants at the end, if a session was joined
  std::vector<SeenHand> others;        ///< hands of the other participants at the end
  std::optional<FarReport> far;        ///< if another program has all of the points
  std::optional<LogReport> log;
  std::string remembered;                   ///< for the first hand's device, in words; empty: nothing
  std::vector<FurtherHandReport> hands;     ///< after the first
  std::optional<ForceDifference> recorded;  ///< from the forces of the replayed trajectory
};

void printReport(std::FILE* out, const TouchReport& report);

}  // namespace palpate
