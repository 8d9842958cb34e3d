#include "engine/io/cloud_arrays.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <vector>

#include "engine/core/error.hpp"
#include "engine/io/ply_vertices.hpp"
#include "engine/io/point_batch.hpp"

namespace palpate {

namespace {

constexpr const char* kName = "the arrays";

struct ArrayGroup {
  const NumberRows* rows;
  std::array<const char*, 3> names;

  std::size_t rowBytes() const { return 3 * sizeOf(rows->type); }
  const std::byte* row(std::uint64_t i) const {
    const auto stride = rows->stride != 0 ? rows->stride : static_cast<std::ptrdiff_t>(rowBytes());
    return rows->data + static_cast<std::ptrdiff_t>(i) * stride;
  }
};

std::vector<ArrayGroup> groupsOf(const CloudArrays& arrays) {
  if (!arrays.positions.data && arrays.count > 0) throw UsageError("positions: are missing");
  std::vector<ArrayGroup> groups{{&arrays.positions, {"x", "y", "z"}}};
  if (arrays.normals.data) groups.push_back({&arrays.normals, {"nx", "ny", "nz"}});
  if (arrays.colors.data) groups.push_back({&arrays.colors, {"red", "green", "blue"}});
  return groups;
}

float numberAt(const NumberRows& rows, const std::byte* row, std::size_t column) {
  if (rows.type == ScalarType::f32) return loadScalar<float>(row + column * sizeof(float));
  return static_cast<float>(loadScalar<double>(row + column * sizeof(double)));
}

/// Colours as floats of 0 to 1; if the maximum exceeds 1 they are taken as 0 to 255.
std::vector<float> colorsOf(const ArrayGroup& group, std::uint64_t count) {
  constexpr float kMaxByte = 255, kRounded = 1e-3f;  // tolerance by which colours of 0 to 1 may exceed 1
  std::vector<float> colors;
  colors.reserve(3 * count);
  float most = 0;
  for (std::uint64_t i = 0; i < count; ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const float color = numberAt(*group.rows, group.row(i), k);
      if (!std::isfinite(color)) throw UsageError("colors: row {}: {} is {}", i, group.names[k], color);
      if (color < 0 || color > kMaxByte + kRounded)
        throw UsageError("colors: row {}: {} is {}; floats are 0 to 1, or 0 to 255", i, group.names[k], color);
      colors.push_back(color);
      most = std::max(most, color);
    }
  if (most > 1 + kRounded)
    for (float& color : colors) color /= kMaxByte;
  return colors;
}

}  // namespace

PointCloud cloudOf(const CloudArrays& arrays, Log* log) {
  std::vector<ArrayGroup> groups = groupsOf(arrays);
  std::vector<float> colors;
  NumberRows even;
  if (arrays.colors.data && (arrays.colors.type == ScalarType::f32 || arrays.colors.type == ScalarType::f64)) {
    colors = colorsOf(groups.back(), arrays.count);
    even.data = reinterpret_cast<const std::byte*>(colors.data());
    groups.back().rows = &even;
  }
  PlyElement element{.name = "vertex", .count = arrays.count, .properties = {}, .line = 1};
  for (const ArrayGroup& group : groups)
    for (const char* name : group.names) element.properties.push_back({.name = name, .type = group.rows->type});
  PlyVertices vertices(kName, element, log, BadRows::refuse);
  vertices.reserve(arrays.count);
  std::vector<std::byte> packed(kPointBatch * vertices.rowBytes());
  for (std::uint64_t begin = 0; begin < arrays.count; begin += kPointBatch) {
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(kPointBatch, arrays.count - begin));
    std::byte* to = packed.data();
    for (std::size_t i = 0; i < count; ++i)
      for (const ArrayGroup& group : groups) {
        std::memcpy(to, group.row(begin + i), group.rowBytes());
        to += group.rowBytes();
      }
    if (const auto bad = vertices.append(packed.data(), count, false))
      throw UsageError("row {} of {}, counted from 0: {}", begin + bad->row, arrays.count, bad->what);
  }
  return vertices.finish(log);
}

}  // namespace palpate
