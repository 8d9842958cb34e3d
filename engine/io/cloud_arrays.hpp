// A cloud from arrays in memory, as from a file of the same columns.
#pragma once

#include <cstddef>
#include <cstdint>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/log.hpp"

namespace palpate {

/// Three numbers a point, next to one another; each row `stride` bytes behind the one before.
struct NumberRows {
  const std::byte* data = nullptr;  ///< null: there are none
  ScalarType type = ScalarType::f32;
  std::ptrdiff_t stride = 0;  ///< bytes; 0: the rows follow one another. May be negative, as of an array turned round.
};

/// Rows for each of `count` points.
struct CloudArrays {
  std::uint64_t count = 0;
  NumberRows positions;  ///< model units
  NumberRows normals;    ///< f32 or f64, of any length but infinite
  NumberRows colors;     ///< u8, 0 to 255; u16, 0 to 65535; f32 and f64, 0 to 1, or 0 to 255 where any is above 1
};

/// Copies them, with the same care as of a file: doubles keep their precision (PointCloud::origin), normals are made
/// unit length, and those that are zero are taken from the nearest point that has one. `log`: null: nobody hears of
/// that. Throws UsageError that names the first row which is not finite or is no colour, and for positions that are not
/// given.
PointCloud cloudOf(const CloudArrays& arrays, Log* log);

}  // namespace palpate
