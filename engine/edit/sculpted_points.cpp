#include "engine/edit/sculpted_points.hpp"

#include <algorithm>
#include <cstring>
#include <numeric>

#include "engine/core/check.hpp"
#include "engine/edit/brush_reference.hpp"

namespace palpate {

namespace {

template <class T>
void eraseFlagged(std::vector<T>& values, const std::vector<std::uint8_t>& gone) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (i >= gone.size() || !gone[i]) values[kept++] = values[i];
  values.resize(kept);
}

std::uint32_t mixedColor(std::uint32_t a, std::uint32_t b) {
  auto mixed = unpackedColor(a);
  const auto other = unpackedColor(b);
  for (std::size_t k = 0; k < mixed.size(); ++k) mixed[k] = static_cast<std::uint8_t>((mixed[k] + other[k] + 1) / 2);
  return packedColor(mixed);
}

Vec3 middleNormal(const Vec3& a, const Vec3& b) {
  const Vec3 sum = a + b;
  const float length = glm::length(sum);
  return length > 1e-3f ? sum / length : a;
}

// `parents`: for each point of the result the one of `data` that it comes from.
std::vector<std::byte> gathered(const std::vector<std::byte>& data, std::size_t bytesEach,
                                const std::vector<std::uint32_t>& parents) {
  std::vector<std::byte> result(parents.size() * bytesEach);
  for (std::size_t i = 0; i < parents.size(); ++i)
    std::memcpy(&result[i * bytesEach], &data[parents[i] * bytesEach], bytesEach);
  return result;
}

}  // namespace

SculptedPoints::SculptedPoints(const PointCloud& cloud)
    : positions(cloud.positions),
      normals(cloud.normals),
      colors(cloud.colors.size()),
      ids(cloud.size()),
      parents(cloud.size()),
      unsettled(cloud.size(), 0) {
  PALPATE_CHECK_EQ(normals.size(), positions.size());
  std::ranges::transform(cloud.colors, colors.begin(), packedColor);
  std::iota(ids.begin(), ids.end(), 0);
  std::iota(parents.begin(), parents.end(), 0);
}

void SculptedPoints::insertBetween(std::uint32_t number, std::uint32_t other, const Vec3& position, std::uint32_t id) {
  positions.push_back(position);
  normals.push_back(middleNormal(normals[number], normals[other]));
  if (!colors.empty()) colors.push_back(mixedColor(colors[number], colors[other]));
  ids.push_back(id);
  parents.push_back(parents[number]);
  spacings.push_back(0.5f * (spacings[number] + spacings[other]));
  unsettled.push_back(1);
}

void SculptedPoints::erase(const std::vector<std::uint8_t>& gone) {
  eraseFlagged(positions, gone);
  eraseFlagged(normals, gone);
  eraseFlagged(colors, gone);
  eraseFlagged(ids, gone);
  eraseFlagged(parents, gone);
  eraseFlagged(spacings, gone);
  eraseFlagged(unsettled, gone);
}

std::size_t SculptedPoints::readBack(PointCloud& cloud) const {
  const std::size_t before = cloud.size();
  std::size_t changed = before;  // as many have gone, less those that are found
  for (std::size_t i = 0; i < size(); ++i) {
    if (ids[i] >= before) {
      ++changed;
      continue;
    }
    const bool same = positions[i] == cloud.positions[ids[i]] &&
                      (colors.empty() || (cloud.hasColors() && colors[i] == packedColor(cloud.colors[ids[i]])));
    changed -= same;
  }
  for (Attribute& attribute : cloud.extra)
    if (before > 0) attribute.data = gathered(attribute.data, attribute.data.size() / before, parents);
  if (!cloud.exactPositions.empty()) {
    std::vector<DVec3> exact;
    exact.reserve(size());
    for (const std::uint32_t parent : parents) exact.push_back(cloud.exactPositions[parent]);
    cloud.exactPositions = std::move(exact);
  }
  cloud.positions = positions;
  cloud.normals = normals;
  cloud.colors.resize(colors.size());
  std::ranges::transform(colors, cloud.colors.begin(), unpackedColor);
  return changed;
}

}  // namespace palpate
