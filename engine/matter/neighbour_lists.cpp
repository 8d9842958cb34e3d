#include "engine/matter/neighbour_lists.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

#include "engine/core/widest_lanes.hpp"
#include "engine/matter/lanes.hpp"

namespace palpate {

namespace {

// For each set of `N` lanes: their numbers, first to last.
template <std::size_t N>
constexpr auto kChosen = [] {
  std::array<std::array<std::uint32_t, N>, 1 << N> all{};
  for (std::size_t bits = 0; bits < all.size(); ++bits)
    for (std::uint32_t lane = 0, count = 0; lane < N; ++lane)
      if ((bits >> lane & 1) != 0) all[bits][count++] = lane;
  return all;
}();

// Consecutive slots in which neighbours are searched, and the image of these.
struct Run {
  std::uint32_t begin, end, image;
};
constexpr std::size_t kMaxRuns = 3 * shared::kRowsAbout;

// What is searched for the neighbours of a slot: coordinates by slot, for a few more than there are, and runs of slots.
struct Search {
  const CellGrid& grid;
  std::array<const float*, 3> along;
  std::span<const Run> runs;
  float reach2;
};

// Appends the slots that are nearer than the reach to a list of `count`, and returns its length.
template <std::size_t N>
std::size_t listBy(const Search& search, std::uint32_t self, Neighbour* list, std::size_t count) {
  using Many = LanesOf<N>;
  const Vec3 place(search.along[0][self], search.along[1][self], search.along[2][self]);
  for (const Run& run : search.runs) {
    const Vec3 seenFrom = place - search.grid.shiftOf(run.image);
    const Many x(seenFrom.x), y(seenFrom.y), z(seenFrom.z);
    const auto first = std::bit_cast<std::uint32_t>(Neighbour{run.begin, run.image});
    for (std::uint32_t j = run.begin; j < run.end; j += N) {
      const Many offX = x - Many::at(search.along[0] + j), offY = y - Many::at(search.along[1] + j),
                 offZ = z - Many::at(search.along[2] + j);
      unsigned near = areBelow(offX * offX + offY * offY + offZ * offZ, Many(search.reach2));
      if (run.end - j < N) near &= (1u << (run.end - j)) - 1;
      if (self - j < N) near &= ~(1u << (self - j));
      // All are written; what is not near is overwritten by the next ones.
      std::array<std::uint32_t, N> slots;
      for (std::size_t k = 0; k < N; ++k) slots[k] = first + (j - run.begin) + kChosen<N>[near][k];
      std::memcpy(list + count, slots.data(), sizeof(slots));
      count += static_cast<std::size_t>(std::popcount(near));
    }
  }
  return count;
}

#ifdef PALPATE_WITH_AVX2
PALPATE_WITH_AVX2 std::size_t listNear(const Search& search, std::uint32_t self, Neighbour* list, std::size_t count) {
  return listBy<8>(search, self, list, count);
}
#endif
PALPATE_WITHOUT_AVX2 std::size_t listNear(const Search& search, std::uint32_t self, Neighbour* list,
                                          std::size_t count) {
  return listBy<4>(search, self, list, count);
}

}  // namespace

bool NeighbourLists::build(const CellGrid& grid, std::span<const Vec4> places, WorkerTeam& team) {
  blocks_.resize(blocksOf(places.size()));
  for (std::size_t axis = 0; axis < along_.size(); ++axis) {
    along_[axis].resize(places.size() + kListedTogether);
    for (std::size_t i = 0; i < places.size(); ++i) along_[axis][i] = places[i][static_cast<int>(axis)];
  }
  team.forEach(blocks_.size(), [&](std::size_t block) { buildBlock(grid, places, block); });
  return std::ranges::none_of(blocks_, &Block::crowded);
}

void NeighbourLists::buildBlock(const CellGrid& grid, std::span<const Vec4> places, std::size_t block) {
  Block& made = blocks_[block];
  const std::size_t begin = block * kSlotsOfBlock, end = std::min(begin + kSlotsOfBlock, places.size());
  made.first.assign(1, 0);
  made.counts.clear();
  made.crowded = false;
  std::size_t count = 0, most = 0, runCount = 0;
  std::array<Run, kMaxRuns + 1> runs;
  IVec3 cell(-1);
  for (std::size_t i = begin; i < end; ++i) {
    const Vec3 place(places[i]);
    // Particles of a cell have the same runs.
    if (const IVec3 own = cellOf(grid.cells(), place); own != cell) {
      cell = own;
      runCount = most = 0;
      grid.forEachRun(place, [&](std::uint32_t from, std::uint32_t to, std::uint32_t image) {
        Run& run = runs[runCount];
        run.begin = from;
        run.end = to;
        run.image = image;
        runCount += from < to ? 1 : 0;
        most += to - from;
      });
    }
    const std::size_t room = count + most + 2 * kListedTogether;
    if (made.neighbours.size() < room) made.neighbours.resize(2 * room);
    const Search search{
        grid, {along_[0].data(), along_[1].data(), along_[2].data()}, std::span(runs).first(runCount), reach_ * reach_};
    count = listNear(search, static_cast<std::uint32_t>(i), made.neighbours.data(), count);
    const std::size_t first = made.first.back();
    made.crowded |= count > first + kMaxNeighbours;
    count = std::min(count, first + kMaxNeighbours);
    made.counts.push_back(static_cast<std::uint32_t>(count - first));
    for (; count % kListedTogether != 0; ++count) made.neighbours[count] = made.neighbours[count - 1];
    made.first.push_back(static_cast<std::uint32_t>(count));
  }
}

}  // namespace palpate
