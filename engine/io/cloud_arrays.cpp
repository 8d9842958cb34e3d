#include "engine/io/cloud_arrays.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

#include "engine/core/error.hpp"
#include "engine/io/ply_vertices.hpp"
#include "engine/io/point_batch.hpp"

namespace palpate {

namespace {

constexpr const char* kName = "the arrays";

struct Group {
  const NumberRows* rows;
  std::array<const char*, 3> names;

  std::size_t rowBytes() const { return 3 * sizeOf(rows->type); }
  const std::byte* row(std::uint64_t i) const {
    const auto stride = rows->stride != 0 ? rows->stride : static_cast<std::ptrdiff_t>(rowBytes());
    return rows->data + static_cast<std::ptrdiff_t>(i) * stride;
  }
};

std::vector<Group> groupsOf(const CloudArrays& arrays) {
  if (!arrays.positions.data && arrays.count > 0) throw UsageError("positions: are not given");
  std::vector<Group> groups{{&arrays.positions, {"x", "y", "z"}}};
  if (arrays.normals.data) groups.push_back({&arrays.normals, {"nx", "ny", "nz"}});
  if (arrays.colors.data) groups.push_back({&arrays.colors, {"red", "green", "blue"}});
  return groups;
}

}  // namespace

PointCloud cloudOf(const CloudArrays& arrays, Log* log) {
  const std::vector<Group> groups = groupsOf(arrays);
  PlyElement element{.name = "vertex", .count = arrays.count, .properties = {}, .line = 1};
  for (const Group& group : groups)
    for (const char* name : group.names) element.properties.push_back({.name = name, .type = group.rows->type});
  PlyVertices vertices(kName, element, log, BadRows::refuse);
  vertices.reserve(arrays.count);
  std::vector<std::byte> packed(kPointBatch * vertices.rowBytes());
  for (std::uint64_t begin = 0; begin < arrays.count; begin += kPointBatch) {
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(kPointBatch, arrays.count - begin));
    std::byte* to = packed.data();
    for (std::size_t i = 0; i < count; ++i)
      for (const Group& group : groups) {
        std::memcpy(to, group.row(begin + i), group.rowBytes());
        to += group.rowBytes();
      }
    if (const auto bad = vertices.append(packed.data(), count, false))
      throw UsageError("row {}: {}", begin + bad->row, bad->what);
  }
  return vertices.finish(log);
}

}  // namespace palpate
