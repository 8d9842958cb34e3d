#pragma once

#include "apps/cli/model.hpp"
#include "engine/cloud/length_unit.hpp"
#include "engine/contact/surface.hpp"
#include "engine/core/touch_backend.hpp"
#include "engine/matter/matter_scene.hpp"
#include "engine/motion/brick_source.hpp"
#include "engine/motion/play_counts.hpp"
#include "engine/motion/rigid_motion.hpp"
#include "haptics/far_cloud.hpp"
#include "haptics/servo_loop.hpp"
#include "haptics/session/edit_relay.hpp"
#include "haptics/sharing/ros.hpp"
#include "haptics/trajectory.hpp"

namespace palpate {

/// Largest distance of the proxy from the surface that double precision finds on the CPU, over up to 200 fresh ticks in
/// contact from before the first edit. Of a model that moves, where it rests.
struct ContactError {
  double worst_mm = 0;
  std::size_t ticks = 0;      ///< looked at
  std::size_t undefined = 0;  ///< of them, where double precision finds no surface at all
};
ContactError contactError(const Trace& trace, const Model& model, const SurfaceOptions& surface,
                          std::optional<double> firstEditTime_s, const std::optional<RigidMotion>& motion);

/// What the servo loop counted besides the trace.
struct ServoReport {
  TickHistogram step_us, late_us;
  SchedulingStatistics scheduling;
  GateCounts withheld;
  std::optional<double> leastEnergy_mJ;
};
ServoReport servoReport(const ServoResult& result);

/// The session log, as it ended.
struct LogReport {
  std::uint64_t bytes = 0, lostTicks = 0, mergedEdits = 0;
};

/// What the second hand's part of a session came to.
struct SecondHandReport {
  std::string device;
  TraceSummary trace;
  HandCounts counts;
};

/// What moved by itself.
struct MatterReport {
  Matter matter = Matter::water;
  std::uint32_t substeps = 0;  ///< in a millisecond
  double gain = 1;             ///< of the forces
  double coupling_N_mm =
      0;                   ///< of the hand to its ball, with the gain; 0: of a soft body, which the hand itself presses
  std::string elasticity;  ///< of a soft body, in words
  double leftOut_s = 0;    ///< by which it stayed behind the clock
  std::uint64_t advances = 0;          ///< times that it went on, each some milliseconds at once
  double duration_s = 0;               ///< in which it did
  SurfaceHolds holds = {};             ///< of a soft body
  std::vector<PortEnergy> ports = {};  ///< of each hand
};

/// How the points around the hands came.
struct FarReport {
  FarCounts counts;
  UnknownTicks ticks;
};

/// What goes before the first answer, from the beginning of the command on, and how long it took.
struct StartStage {
  std::string_view name;
  double time_s = 0;
};

/// What a touch session came to.
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
  std::size_t movedPoints = 0;  ///< that lie elsewhere than in the file
  bool realtimePriority = false;
  bool pacedByDevice = false;
  bool realtime = false;
  bool interrupted = false;
  bool edits = false;
  double radius_mm = 0, cell_mm = 0, spacing_mm = 0, noise_spacings = 0, mm_per_unit = 1;
  double longestSide = 0;  ///< model units
  LengthUnit unit = LengthUnit::unknown;
  std::string tool;
  std::size_t toolPoints = 0;  ///< 0: it touches with the HIP alone
  ContactError error;
  std::optional<PlayCounts> frames;    ///< where the model is a depth camera
  std::optional<MatterReport> matter;  ///< where the model is a scene
  std::optional<StrokeCounts> shape;   ///< of a soft body with a brush
  std::optional<UndoneStrokes> back;   ///< where undo was asked for
  std::optional<RosHand::Counts> ros;  ///< where programs of ROS hear it
  std::optional<SharedCounts> shared;  ///< where others feel and sculpt it, too
  std::optional<std::size_t> cameras;  ///< of others who look at what was joined, in the end
  std::vector<SeenHand> others;        ///< hands of others that were there in the end
  std::optional<FarReport> far;        ///< where somebody else has all of the points
  std::optional<LogReport> log;
  std::optional<SecondHandReport> second;   ///< where there was one
  std::optional<ForceDifference> recorded;  ///< from the forces of the trajectory that was replayed
};

void printReport(std::FILE* out, const TouchReport& report);
Json toJson(const TouchReport& report);

}  // namespace palpate
