#include "engine/matter/neighbour_lists.hpp"

#include <algorithm>

namespace palpate {

bool NeighbourLists::build(const CellGrid& grid, std::span<const Vec4> places, WorkerTeam& team) {
  blocks_.resize(blocksOf(places.size()));
  team.forEach(blocks_.size(), [&](std::size_t block) { buildBlock(grid, places, block); });
  return std::ranges::none_of(blocks_, &Block::crowded);
}

void NeighbourLists::buildBlock(const CellGrid& grid, std::span<const Vec4> places, std::size_t block) {
  Block& made = blocks_[block];
  const std::size_t begin = block * kSlotsOfBlock, end = std::min(begin + kSlotsOfBlock, places.size());
  const float reach2 = reach_ * reach_;
  made.first.assign(1, 0);
  made.counts.clear();
  made.crowded = false;
  std::size_t count = 0;
  for (std::size_t i = begin; i < end; ++i) {
    const std::size_t most = count + kMaxNeighbours;
    const Vec3 place(places[i]);
    grid.forEachRun(place, [&](std::uint32_t from, std::uint32_t to, std::uint32_t image) {
      const Vec3 seenFrom = place - grid.shiftOf(image);
      const auto self = static_cast<std::uint32_t>(i);
      // Room for the whole run: each candidate is written, and kept only if near.
      if (made.neighbours.size() < count + (to - from)) made.neighbours.resize(2 * (count + (to - from)));
      Neighbour* const out = made.neighbours.data();
      for (std::uint32_t j = from; j < to; ++j) {
        const Vec3 offset = seenFrom - Vec3(places[j]);
        out[count] = {j, image};
        count += static_cast<std::size_t>(glm::dot(offset, offset) < reach2 && j != self);
      }
      made.crowded |= count > most;
      count = std::min(count, most);
    });
    made.counts.push_back(static_cast<std::uint32_t>(count - made.first.back()));
    if (made.neighbours.size() < count + kListedTogether) made.neighbours.resize(2 * (count + kListedTogether));
    for (; count % kListedTogether != 0; ++count) made.neighbours[count] = made.neighbours[count - 1];
    made.first.push_back(static_cast<std::uint32_t>(count));
  }
}

}  // namespace palpate
