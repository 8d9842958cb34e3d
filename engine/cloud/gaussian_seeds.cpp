#include "engine/cloud/gaussian_seeds.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <numbers>
#include <tuple>

#include "engine/cloud/counter_random.hpp"
#include "engine/cloud/morton.hpp"
#include "engine/core/parallel_collect.hpp"

namespace palpate {

namespace {

constexpr float kSeedArea = 0.8f;  // area of the discs per seed
constexpr float kRim = 1.1f;       // in deviations: the covered part of a disc
constexpr int kFinestLevel = 2;    // cells of four voxels: about as wide as the reach of the Gaussians in them
constexpr std::uint64_t kMaxCellsOfDisc = 1000;  // on average; with many large discs coarser cells are cheaper

std::size_t seedsOfDisc(const GaussianDisc& disc, std::size_t i) {
  constexpr std::uint64_t kStream = 1;  // of random numbers
  const double wanted = static_cast<double>(kRim * kRim * disc.area() / kSeedArea);
  return static_cast<std::uint32_t>(wanted + randomUnit(kStream, i));
}

/// Writes `count` seeds over disc `i`.
void seedDisc(const GaussianDisc& disc, std::size_t i, std::size_t count, GaussianSeed* seeds) {
  constexpr std::uint64_t kStream = 2;
  constexpr double kGoldenCosine = -0.7373688780783197, kGoldenSine = 0.6754902942615238;  // of 2.399963229728653
  const double turned = 2 * std::numbers::pi * randomUnit(kStream, i);
  double cosine = std::cos(turned), sine = std::sin(turned);
  for (std::size_t k = 0; k < count; ++k) {
    const double out = kRim * std::sqrt((static_cast<double>(k) + 0.5) / static_cast<double>(count));
    const Vec3 place =
        disc.center + static_cast<float>(out * cosine) * disc.longest + static_cast<float>(out * sine) * disc.middle;
    seeds[k] = {mortonCode(mortonCell(place, kSeedVoxel)), place, static_cast<std::uint32_t>(i)};
    const double before = cosine;
    cosine = before * kGoldenCosine - sine * kGoldenSine, sine = before * kGoldenSine + sine * kGoldenCosine;
  }
}

/// The first of the seeds in a voxel, in the order of their discs.
GaussianSeed firstOf(std::span<const GaussianSeed> seeds) {
  const auto order = [](const GaussianSeed& s) { return std::tie(s.disc, s.place.x, s.place.y, s.place.z); };
  std::size_t first = 0;
  for (std::size_t k = 1; k < seeds.size() && seeds[k].disc == seeds[0].disc; ++k)
    if (order(seeds[k]) < order(seeds[first])) first = k;
  return seeds[first];
}

/// The voxels, counted from the outermost one, of a disc's centre and of its reach; both ends included.
struct VoxelBox {
  IVec3 low, middle, high;

  VoxelBox(const GaussianDisc& disc, float margin)
      : low(mortonCell(disc.center - disc.reach - margin, kSeedVoxel)),
        middle(mortonCell(disc.center, kSeedVoxel)),
        high(mortonCell(disc.center + disc.reach + margin, kSeedVoxel)) {}
  std::uint64_t cells(int level) const {
    std::uint64_t count = 1;
    for (int k = 0; k < 3; ++k) count *= static_cast<std::uint64_t>((high[k] >> level) - (low[k] >> level) + 1);
    return count;
  }
  bool staysNextTo(int level) const {
    bool next = true;
    for (int k = 0; k < 3; ++k)
      next = next && (high[k] >> level) - (middle[k] >> level) <= 1 && (middle[k] >> level) - (low[k] >> level) <= 1;
    return next;
  }
};

/// The box in which a Gaussian has an effect.
GaussianRegion regionOf(const FeltGaussian& felt) { return {felt.center - felt.reach, felt.center + felt.reach}; }

}  // namespace

BareVector<GaussianSeed> seedsOver(std::span<const GaussianDisc> discs, unsigned threads) {
  auto begins = parallelMake(discs.size(), threads, [&](std::size_t i) { return seedsOfDisc(discs[i], i); });
  begins.push_back(0);
  const std::size_t total = parallelSumBefore(std::span(begins), threads);
  BareVector<GaussianSeed> all(total);
  parallelFor(discs.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) seedDisc(discs[i], i, begins[i + 1] - begins[i], all.data() + begins[i]);
  });

  sortByMorton(all, threads, [](const GaussianSeed& seed) { return seed.voxel; });

  const auto voxels = parallelRuns(total, threads, [&](std::size_t k) { return all[k].voxel == all[k - 1].voxel; });
  return parallelMake(voxels.size() - 1, threads, [&](std::size_t voxel) {
    return firstOf({all.data() + voxels[voxel], all.data() + voxels[voxel + 1]});
  });
}

SeedCells::SeedCells(std::span<const GaussianDisc> discs, std::span<const GaussianSeed> seeds, float margin,
                     unsigned threads)
    : seeds_(seeds), margin_(margin), level_(finestLevel(discs, threads)) {
  begins_ = parallelRuns(seeds.size(), threads, [&](std::size_t i) {
    return seeds_[i].voxel >> (3 * level_) == seeds_[i - 1].voxel >> (3 * level_);
  });

  sortDiscs(discs, threads);
}

/// The finest level at which large discs do not cover too many cells.
int SeedCells::finestLevel(std::span<const GaussianDisc> discs, unsigned threads) const {
  const auto cellsOfDiscs = [&](int level) {
    const auto cellsOf = [&](std::size_t begin, std::size_t end) {
      std::uint64_t cells = 0;
      for (std::size_t i = begin; i < end; ++i) cells += VoxelBox(discs[i], margin_).cells(level);
      return cells;
    };
    return parallelReduce(discs.size(), threads, std::uint64_t{0}, cellsOf, std::plus<>());
  };
  int level = kFinestLevel;
  while (level < kMortonBits && cellsOfDiscs(level) > kMaxCellsOfDisc * discs.size()) ++level;
  return level;
}

void SeedCells::sortDiscs(std::span<const GaussianDisc> discs, unsigned threads) {
  struct Entry {
    std::uint64_t code;
    std::uint32_t disc, level;
  };
  auto entries = parallelMake(discs.size(), threads, [&](std::size_t i) {
    const VoxelBox box(discs[i], margin_);
    int level = cubeLevel();
    while (!box.staysNextTo(level)) ++level;
    return Entry{mortonCode(box.middle), static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(level)};
  });
  sortByMorton(entries, threads, [](const Entry& entry) { return entry.code; });
  parallelRadixSort(entries, std::bit_width(unsigned{kMortonBits}), threads,
                    [](const Entry& entry) { return entry.level; });
  felt_ = parallelMake(entries.size(), threads, [&](std::size_t k) { return FeltGaussian(discs[entries[k].disc]); });
  const auto ends =
      parallelRuns(entries.size(), threads, [&](std::size_t k) { return entries[k].level == entries[k - 1].level; });
  for (std::size_t g = 0; g + 1 < ends.size(); ++g) {
    const std::size_t first = ends[g];
    const int level = static_cast<int>(entries[first].level);
    const auto codeOf = [&](std::size_t k) { return entries[first + k].code >> (3 * level); };
    Grid& grid = grids_.emplace_back(Grid{
        .level = level, .firstDisc = first, .cells = MortonCells(ends[g + 1] - first, threads, codeOf), .regions = {}});
    grid.regions = parallelMake(grid.cells.count(), threads, [&](std::size_t cell) {
      GaussianRegion region;
      for (std::size_t k = first + grid.cells.begin(cell); k < first + grid.cells.end(cell); ++k)
        region.widen(regionOf(felt_[k]));
      return region;
    });
  }
}

GaussianRegion SeedCells::withMargin(std::size_t cell, int level) const {
  const IVec3 first = (mortonCellOf(seeds_[begins_[cell]].voxel) >> level) << level;
  const Vec3 low = kSeedVoxel * Vec3(first - kMortonReach);
  return {low - margin_, low + kSeedVoxel * static_cast<float>(1 << level) + margin_};
}

void SeedCells::collectAround(std::size_t cell, std::vector<FeltGaussian>& felt) const {
  felt.clear();
  const GaussianRegion region = withMargin(cell, cubeLevel());
  const IVec3 voxel = mortonCellOf(seeds_[begins_[cell]].voxel);
  for (const Grid& grid : grids_)
    grid.cells.forEachAround(voxel >> grid.level, [&](std::uint32_t near) {
      if (!grid.regions[near].meets(region)) return;
      for (std::size_t k = grid.firstDisc + grid.cells.begin(near); k < grid.firstDisc + grid.cells.end(near); ++k)
        if (regionOf(felt_[k]).meets(region)) felt.push_back(felt_[k]);
    });
}

void GaussiansAround::gather(std::size_t cell, const GaussianRegion& region, GaussianDensity& density) {
  if (cells_.cubeOf(cell) != cube_) moveTo(cell);
  const GaussianRegion most = cells_.withMargin(cell);
  chooseIn({glm::max(region.low, most.low), glm::min(region.high, most.high)});
  density.fill(felt_, chosen_);
}

void GaussiansAround::moveTo(std::size_t cell) {
  cube_ = cells_.cubeOf(cell);
  cells_.collectAround(cell, felt_);
  boxes_.resize((felt_.size() + kLanes - 1) / kLanes);
  for (std::size_t i = 0; i < boxes_.size() * kLanes; ++i) {
    const GaussianRegion region = i < felt_.size() ? regionOf(felt_[i]) : GaussianRegion();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      boxes_[i / kLanes].low[axis][i % kLanes] = region.low[static_cast<int>(axis)];
      boxes_[i / kLanes].high[axis][i % kLanes] = region.high[static_cast<int>(axis)];
    }
  }
}

/// As GaussianRegion::meets(), but without branches, so that boxes are tested in parallel.
void GaussiansAround::chooseIn(const GaussianRegion& region) {
  chosen_.resize(boxes_.size() * kLanes);
  std::size_t count = 0;
  std::uint32_t number = 0;
  for (const Boxes& boxes : boxes_) {
    std::array<std::int32_t, kLanes> meets;
    const auto& [low, high] = boxes;
    for (std::size_t k = 0; k < kLanes; ++k)
      meets[k] = (low[0][k] < region.high.x) & (low[1][k] < region.high.y) & (low[2][k] < region.high.z) &
                 (region.low.x < high[0][k]) & (region.low.y < high[1][k]) & (region.low.z < high[2][k]);
    for (const std::int32_t one : meets) {
      chosen_[count] = number++;
      count += static_cast<std::size_t>(one);
    }
  }
  chosen_.resize(count);
}

}  // namespace palpate
