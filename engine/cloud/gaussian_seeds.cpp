#include "engine/cloud/gaussian_seeds.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

#include "engine/cloud/counter_random.hpp"
#include "engine/cloud/morton.hpp"
#include "engine/core/parallel.hpp"
#include "engine/core/parallel_sort.hpp"

namespace palpate {

namespace {

constexpr float kSeedArea = 0.8f;  // of the discs, for each seed
constexpr float kRim = 1.1f;       // deviations that a disc is covered to
constexpr int kFinestLevel = 2;    // cells of four voxels: about as wide as what is felt in them reaches
constexpr std::uint64_t kMostCellsOfDisc =
    1000;  // on average, so that many large discs cost no more than coarser cells

std::uint32_t seedsOfDisc(const GaussianDisc& disc, std::size_t i) {
  constexpr std::uint64_t kStream = 1;  // of random numbers
  const double wanted = static_cast<double>(kRim * kRim * disc.area() / kSeedArea);
  return static_cast<std::uint32_t>(wanted + randomUnit(kStream, i));
}

}  // namespace

bool GaussianSeed::operator<(const GaussianSeed& other) const {
  const auto order = [](const GaussianSeed& s) { return std::tie(s.voxel, s.disc, s.place.x, s.place.y, s.place.z); };
  return order(*this) < order(other);
}

std::vector<GaussianSeed> seedsOver(std::span<const GaussianDisc> discs, unsigned threads) {
  std::vector<std::size_t> begins(discs.size() + 1, 0);
  for (std::size_t i = 0; i < discs.size(); ++i) begins[i + 1] = begins[i] + seedsOfDisc(discs[i], i);
  std::vector<GaussianSeed> seeds(begins.back());
  parallelFor(discs.size(), threads, [&](std::size_t begin, std::size_t end) {
    constexpr std::uint64_t kStream = 2;
    constexpr double kGoldenAngle = 2.399963229728653;
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t count = begins[i + 1] - begins[i];
      const double turned = 2 * std::numbers::pi * randomUnit(kStream, i);
      for (std::size_t k = 0; k < count; ++k) {
        const double out = kRim * std::sqrt((static_cast<double>(k) + 0.5) / static_cast<double>(count));
        const double angle = turned + kGoldenAngle * static_cast<double>(k);
        const Vec3 place = discs[i].center + static_cast<float>(out * std::cos(angle)) * discs[i].longest +
                           static_cast<float>(out * std::sin(angle)) * discs[i].middle;
        seeds[begins[i] + k] = {mortonCode(mortonCell(place, kSeedVoxel)), place, static_cast<std::uint32_t>(i)};
      }
    }
  });
  parallelSort(seeds, threads);
  const auto sameVoxel = [](const GaussianSeed& a, const GaussianSeed& b) { return a.voxel == b.voxel; };
  const auto rest = std::ranges::unique(seeds, sameVoxel);
  seeds.erase(rest.begin(), rest.end());
  return seeds;
}

SeedCells::SeedCells(std::span<const GaussianDisc> discs, std::span<const GaussianSeed> seeds, float margin,
                     unsigned threads)
    : discs_(discs), seeds_(seeds), margin_(margin), level_(kFinestLevel) {
  divide(threads);
  listDiscs(threads);
}

SeedCells::Box SeedCells::boxOf(const GaussianDisc& disc) const {
  const Vec3 reach = disc.reach + margin_;
  Box box{mortonCell(disc.center - reach, kSeedVoxel), mortonCell(disc.center + reach, kSeedVoxel)};
  for (int k = 0; k < 3; ++k) box.low[k] >>= level_, box.high[k] >>= level_;
  return box;
}

/// Cells as fine as their lists may be long.
void SeedCells::divide(unsigned threads) {
  const auto cellsOfDiscs = [&] {
    std::atomic<std::uint64_t> cells = 0;
    parallelFor(discs_.size(), threads, [&](std::size_t begin, std::size_t end) {
      std::uint64_t own = 0;
      for (std::size_t i = begin; i < end; ++i) {
        const Box box = boxOf(discs_[i]);
        const glm::u64vec3 size(box.high - box.low + 1);
        own += size.x * size.y * size.z;
      }
      cells += own;
    });
    return cells.load();
  };
  while (level_ < kMortonBits && cellsOfDiscs() > kMostCellsOfDisc * discs_.size()) ++level_;
  std::vector<std::uint64_t> codes;
  for (std::size_t i = 0; i < seeds_.size(); ++i) {
    const std::uint64_t code = seeds_[i].voxel >> (3 * level_);
    if (!codes.empty() && codes.back() == code) continue;
    codes.push_back(code);
    begins_.push_back(i);
  }
  begins_.push_back(seeds_.size());
  cells_ = MortonCells(std::move(codes));
}

/// Each part of the discs notes its pairs of cell and disc; they are counted, and then each has its place, in the order
/// of the discs whoever noted them.
void SeedCells::listDiscs(unsigned threads) {
  struct Pair {
    std::uint32_t cell, disc;
  };
  const std::size_t parts = threadCount(threads);
  std::vector<std::vector<Pair>> pairs(parts);
  std::vector<std::vector<std::uint32_t>> counts(parts);
  const auto notePart = [&](std::size_t part) {
    counts[part].assign(cells_.count(), 0);
    for (std::size_t i = discs_.size() * part / parts; i < discs_.size() * (part + 1) / parts; ++i) {
      const Box box = boxOf(discs_[i]);
      for (int z = box.low.z; z <= box.high.z; ++z)
        for (int y = box.low.y; y <= box.high.y; ++y) {
          const std::uint64_t row = mortonCode({0, y, z});
          for (int x = box.low.x; x <= box.high.x; ++x)
            if (const auto cell = cells_.find(row | spreadBits(static_cast<std::uint64_t>(x)))) {
              pairs[part].push_back({*cell, static_cast<std::uint32_t>(i)});
              ++counts[part][*cell];
            }
        }
    }
  };
  parallelParts(parts, notePart);
  listBegins_.assign(cells_.count() + 1, 0);
  std::size_t total = 0;
  for (std::size_t cell = 0; cell < cells_.count(); ++cell) {
    listBegins_[cell] = total;
    for (auto& count : counts)
      total += std::exchange(count[cell], static_cast<std::uint32_t>(total - listBegins_[cell]));
  }
  listBegins_.back() = total;
  lists_.resize(total);
  parallelParts(parts, [&](std::size_t part) {
    for (const Pair& pair : pairs[part]) lists_[listBegins_[pair.cell] + counts[part][pair.cell]++] = pair.disc;
  });
}

void SeedCells::gather(std::size_t cell, const Region& region, GaussianDensity& density) const {
  density.clear();
  const Vec3 middle = 0.5f * (region.low + region.high), half = 0.5f * (region.high - region.low);
  for (std::size_t k = listBegins_[cell]; k < listBegins_[cell + 1]; ++k) {
    const GaussianDisc& disc = discs_[lists_[k]];
    const Vec3 off = glm::abs(disc.center - middle) - half;
    if (off.x < disc.reach.x && off.y < disc.reach.y && off.z < disc.reach.z) density.add(disc);
  }
}

}  // namespace palpate
