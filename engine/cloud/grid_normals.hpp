// Normals of what a sensor has seen row by row.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/core/vec.hpp"

namespace palpate {

/// The rays of a sensor, row by row, of which some have met a surface.
struct SensorGrid {
  std::uint32_t width = 0, height = 0;
  std::span<const std::uint32_t> cells;  ///< of each place: row * width + column, ascending
  DVec3 sensor{0};                       ///< where it stands, relative to what places are relative to
};

/// By central differences along rows and columns, as of pictures of depth (engine/motion/depth_points.hpp): unit,
/// towards the sensor, and 0 where nobody knows. A difference reaches over no jump: over none by more than a surface is
/// far from ray to ray that is seen at less than 84 degrees from upright, or than such a sensor's noise.
std::vector<Vec3> gridNormals(std::span<const Vec3> places, const SensorGrid& grid);

}  // namespace palpate
