#include "engine/study/multimap_hash.hpp"

#include <algorithm>

#include "engine/core/check.hpp"

namespace palpate {

void MultimapHash::build(std::span<const Vec3> positions) {
  positions_ = positions;
  map_.clear();
  for (std::uint32_t i = 0; i < positions.size(); ++i) map_.emplace(bucketAt(positions[i]), Point{positions[i], i});
}

void MultimapHash::move(std::span<const PointMove> moves) {
  for (const PointMove& move : moves) {
    const auto [first, last] = map_.equal_range(bucketAt(move.from));
    const auto old = std::find_if(first, last, [&](const auto& entry) { return entry.second.number == move.point; });
    PALPATE_CHECK(old != last);
    map_.erase(old);
    const Vec3& to = positions_[move.point];
    map_.emplace(bucketAt(to), Point{to, move.point});
  }
}

void MultimapHash::near(const DVec3& center, double radius, std::vector<std::uint32_t>& found) const {
  const auto isNear = [&](const Point& point) {
    const DVec3 d = DVec3(point.position) - center;
    return glm::dot(d, d) < radius * radius;
  };
  const CellBox box = cellsAround(grid_, center, radius);
  if (box.cells() > static_cast<double>(map_.size())) {  // a pass over all points is cheaper
    for (const auto& [bucket, point] : map_)
      if (isNear(point)) found.push_back(point.number);
    return;
  }
  box.forEach([&](const IVec3& cell) {
    const auto [first, last] = map_.equal_range(bucketOf(grid_, cell));
    for (auto entry = first; entry != last; ++entry) {
      const Point& point = entry->second;
      if (isNear(point) && cellOf(grid_, point.position) == cell) found.push_back(point.number);
    }
  });
}

std::size_t MultimapHash::bytes() const {
  constexpr std::size_t kLink = sizeof(void*), kBlockHeader = 8, kBlockRounding = 16;
  constexpr std::size_t kEntry = kLink + sizeof(Map::value_type) + kBlockHeader;
  constexpr std::size_t kBlock = (kEntry + kBlockRounding - 1) / kBlockRounding * kBlockRounding;
  return map_.size() * kBlock + map_.bucket_count() * kLink;
}

}  // namespace palpate
