#include "haptics/session/placed_clouds.hpp"

#include <algorithm>
#include <array>

#include "engine/core/counted.hpp"
#include "engine/core/point_state.hpp"
#include "engine/io/cloud_arrays.hpp"

namespace palpate {

namespace {

template <class Element>
NumberRows rowsOf(const std::vector<Element>& rows, ScalarType type) {
  return {.data = reinterpret_cast<const std::byte*>(rows.data()), .type = type, .stride = sizeof(Element)};
}

std::vector<Vec3> normalsOf(const PointCloud& cloud, NormalSource source, const ModelLoading& loading) {
  if (cloud.hasNormals() && source != NormalSource::estimate) return cloud.normals;
  PointCloud copy{.origin = cloud.origin, .positions = cloud.positions};
  const std::string cost = loading.estimate(copy, loading.threads, {});
  loading.log.say("a cloud of {}: normals are estimated from the points: {}", counted(copy.size(), "point"), cost);
  return copy.normals;
}

}  // namespace

PointCloud mergedCloud(std::span<const PlacedCloud> clouds, NormalSource normals, const ModelLoading& loading) {
  std::vector<DVec3> positions;
  std::vector<Vec3> facing;
  std::vector<std::array<std::uint8_t, 4>> colors;
  const bool isColored = std::ranges::any_of(clouds, [](const PlacedCloud& each) { return each.cloud->hasColors(); });
  for (const PlacedCloud& placed : clouds) {
    const PointCloud& cloud = *placed.cloud;
    for (std::size_t i = 0; i < cloud.size(); ++i) positions.push_back(placed.placement(cloud.fileCoordinates(i)));
    for (const Vec3& normal : normalsOf(cloud, normals, loading))
      facing.emplace_back(placed.placement.rotation * DVec3(normal));
    if (!isColored) continue;
    if (cloud.hasColors()) colors.insert(colors.end(), cloud.colors.begin(), cloud.colors.end());
    colors.resize(positions.size(), kUnpainted);
  }
  return cloudOf({.count = positions.size(),
                  .positions = rowsOf(positions, ScalarType::f64),
                  .normals = rowsOf(facing, ScalarType::f32),
                  .colors = isColored ? rowsOf(colors, ScalarType::u8) : NumberRows{}},
                 &loading.log);
}

CloudRows::CloudRows(std::span<const PlacedCloud> clouds) {
  std::size_t end = 0;
  for (const PlacedCloud& placed : clouds) ends_.push_back(end += placed.cloud->size());
}

CloudRows::Row CloudRows::of(std::size_t point) const {
  const auto found = std::ranges::upper_bound(ends_, point);
  if (found == ends_.end()) return {.row = point - ends_.back(), .isInserted = true};
  return {.cloud = static_cast<std::size_t>(found - ends_.begin()),
          .row = found == ends_.begin() ? point : point - *(found - 1)};
}

}  // namespace palpate
