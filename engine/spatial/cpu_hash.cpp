#include "engine/spatial/cpu_hash.hpp"

#include <numeric>

namespace palpate {

CpuHash::CpuHash(std::span<const Vec3> positions, const HashGrid& grid) : positions_(positions), grid_(grid) {
  rebuild();
}

void CpuHash::rebuild() {
  // Counting sort by bucket.
  starts_.assign(std::size_t{grid_.bucketMask} + 2, 0);
  for (const Vec3& position : positions_) ++starts_[bucketOf(grid_, cellOf(grid_, position)) + 1];
  std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
  std::vector<std::uint32_t> next(starts_.begin(), starts_.end() - 1);
  order_.resize(positions_.size());
  for (std::uint32_t i = 0; i < positions_.size(); ++i)
    order_[next[bucketOf(grid_, cellOf(grid_, positions_[i]))]++] = i;
}

}  // namespace palpate
