// Makes a cloud from arrays in memory, like a file with the same columns.
#pragma once

#include <cstddef>
#include <cstdint>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/log.hpp"

namespace palpate {

/// Three contiguous numbers per point; rows are `stride` bytes apart.
struct NumberRows {
  const std::byte* data = nullptr;  ///< null: absent
  ScalarType type = ScalarType::f32;
  std::ptrdiff_t stride = 0;  ///< bytes; 0: contiguous rows. May be negative, for a reversed array.
};

/// Arrays of `count` points.
struct CloudArrays {
  std::uint64_t count = 0;
  NumberRows positions;  ///< model units
  NumberRows normals;    ///< f32 or f64, any finite length
  NumberRows colors;     ///< u8, 0 to 255; u16, 0 to 65535; f32 and f64, 0 to 1, or 0 to 255 if any is above 1
};

/// Copies the arrays with the same checks as for a file: doubles keep their precision (PointCloud::origin), normals are
/// normalised, and zero normals are replaced by that of the nearest point that has one, which is logged (`log` may be
/// null). Throws UsageError that names the first row with a number that is not finite or not a colour, and if positions
/// are missing.
PointCloud cloudOf(const CloudArrays& arrays, Log* log);

}  // namespace palpate
