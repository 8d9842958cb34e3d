// Normals of points that a sensor has seen row by row.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/core/vec.hpp"

namespace palpate {

/// The rays of a sensor, row by row, some of which have hit a surface.
struct SensorGrid {
  std::uint32_t width = 0, height = 0;
  std::span<const std::uint32_t> cells;  ///< of each position: row * width + column, ascending
  DVec3 sensor{0};                       ///< its position, in the frame of the points
};

/// By central differences along rows and columns, as for depth images (engine/motion/depth_points.hpp): unit, towards
/// the sensor, and 0 if unknown. Differences do not cross jumps: changes of distance from ray to ray larger than those
/// of a surface seen at 84 degrees from its normal, and larger than the noise of such a sensor.
std::vector<Vec3> gridNormals(std::span<const Vec3> places, const SensorGrid& grid);

}  // namespace palpate
