// Position-force trajectories, a common format in haptics: positions of a stylus, and the forces on it.
#pragma once

#include <filesystem>
#include <vector>

#include "haptics/path.hpp"
#include "haptics/trace.hpp"

namespace palpate {

struct TrajectorySample {
  double t_s = 0;
  DVec3 position{0};  ///< model units, in the coordinates of the model's file
  DVec3 force_N{0};
};

/// At least one sample; times ascend.
struct Trajectory {
  std::vector<TrajectorySample> samples;
  bool hasForces = false;

  Path path() const;
  /// Linear between the samples. Requires forces.
  DVec3 force_N(double t_s) const noexcept;
};

/// One sample per line: time, position and, in some files, force, separated by commas, semicolons, tabs or blanks, as
/// in Ruffaldi et al. 2006 ("Standardized evaluation of haptic rendering systems"). With a line of names first: t_s, t,
/// time or time_s; x y z, px py pz, pos_x … or hip_x …; force_x …, fx fy fz; other columns are ignored, so that traces
/// can be read. Without one: four columns, or seven. Throws FileError with the line.
Trajectory readTrajectory(const std::filesystem::path& file);

/// Seven columns: with commas and names in a .csv, with blanks and no names in any other file. Throws FileError.
void writeTrajectory(const std::filesystem::path& file, const Trace& trace);

/// Difference of a session's forces from those of the trajectory that it followed.
struct ForceDifference {
  std::size_t ticks = 0;  ///< compared: those within the trajectory's time
  double rms_N = 0, worst_N = 0;
};
ForceDifference compareForces(const Trace& trace, const Trajectory& recorded);

}  // namespace palpate
