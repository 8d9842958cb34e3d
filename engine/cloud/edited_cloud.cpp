#include "engine/cloud/edited_cloud.hpp"

#include <algorithm>
#include <cstring>

#include "engine/cloud/edited_gaussians.hpp"
#include "engine/core/check.hpp"
#include "engine/core/checksum.hpp"
#include "engine/core/error.hpp"
#include "engine/core/packed_state.hpp"

namespace palpate {

std::uint32_t packedColor(const PointCloud& cloud, std::size_t point) {
  if (!cloud.hasColors()) return 0;
  const auto& [r, g, b, a] = cloud.colors[point];
  return r | g << 8u | b << 16u | std::uint32_t{a} << 24u;
}

std::vector<PointState> statesOf(const PointCloud& file) {
  std::vector<PointState> points(file.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i] = {.position = file.positions[i],
                 .number = i,
                 .normal = file.hasNormals() ? file.normals[i] : Vec3(0),
                 .color = packedColor(file, i),
                 .parent = i};
  return points;
}

std::uint64_t checksumOf(const DVec3& origin, std::span<const PointState> points) {
  Checksum sum;
  for (int k = 0; k < 3; ++k) sum.addValue(origin[k]);
  for (const PointState& point : points)
    if (!point.gone) {
      const PackedState entry = packedState(point);
      sum.add(std::as_bytes(std::span(&entry, 1)));
    }
  return sum.value();
}

std::uint64_t ancestorOf(std::span<const PointState> points, std::uint64_t point, std::size_t inFile) {
  for (std::size_t steps = 0; point >= inFile; ++steps) {
    if (steps == points.size() || point >= points.size())
      throw Error("a new point has no ancestor in the file; the edits are of another model, or are damaged");
    point = points[point].parent;
  }
  return point;
}

std::size_t changedPoints(const PointCloud& file, std::span<const PointState> points) {
  PALPATE_CHECK_LE(file.size(), points.size());
  std::size_t changed = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    changed += i < file.size() ? points[i].gone || points[i].position != file.positions[i] ||
                                     points[i].color != packedColor(file, i)
                               : !points[i].gone;
  return changed;
}

PointCloud editedCloud(const PointCloud& file, std::span<const PointState> points) {
  PALPATE_CHECK_LE(file.size(), points.size());
  PointCloud cloud{.origin = file.origin, .storedAs = file.storedAs};
  cloud.storedAs.baggage = editedGaussians(file, points);
  const auto there =
      static_cast<std::size_t>(std::ranges::count_if(points, [](const PointState& point) { return !point.gone; }));
  const bool colors = file.hasColors() || std::ranges::any_of(points, [](const PointState& point) {
                        return !point.gone && point.color != 0;
                      });
  cloud.positions.reserve(there);
  if (file.hasNormals()) cloud.normals.reserve(there);
  if (colors) cloud.colors.reserve(there);
  if (!file.exactPositions.empty()) cloud.exactPositions.reserve(there);
  std::vector<std::uint64_t> sources;  // for every point: the point in the file with its other properties
  sources.reserve(there);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const PointState& point = points[i];
    PALPATE_CHECK_EQ(point.number, i);
    if (point.gone) continue;
    sources.push_back(ancestorOf(points, i, file.size()));
    cloud.positions.push_back(point.position);
    if (file.hasNormals()) cloud.normals.push_back(point.normal);
    if (colors) cloud.colors.push_back(point.color != 0 || file.hasColors() ? unpackedColor(point.color) : kUnpainted);
    if (!file.exactPositions.empty())
      cloud.exactPositions.push_back(i < file.size() ? file.exactPositions[i] : file.origin + DVec3(point.position));
  }
  for (const Attribute& attribute : file.extra) {
    const std::size_t bytes = sizeOf(attribute.type);
    Attribute& carried = cloud.extra.emplace_back(Attribute{attribute.name, attribute.type, {}});
    carried.data.resize(there * bytes);
    for (std::size_t i = 0; i < there; ++i)
      std::memcpy(carried.data.data() + i * bytes, attribute.data.data() + sources[i] * bytes, bytes);
  }
  return cloud;
}

}  // namespace palpate
