// Positions spread over the discs of Gaussians, and the Gaussians that contribute around each of them.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vector_relational.hpp>
#include <limits>
#include <span>
#include <vector>

#include "engine/cloud/gaussian_density.hpp"
#include "engine/cloud/morton.hpp"
#include "engine/core/bare_vector.hpp"

namespace palpate {

inline constexpr float kSeedVoxel = 0.85f;  ///< usual radii: the side of the voxels that have one seed each

/// Lengths in usual radii.
struct GaussianSeed {
  std::uint64_t voxel = 0;  ///< Morton code
  Vec3 place{0};
  std::uint32_t disc = 0;
};

/// The number of seeds on a disc is proportional to its area; they lie in a spiral of even area (Vogel 1979). Each
/// voxel keeps only the first disc's seed. Ordered by voxels. The result does not depend on `threads`.
BareVector<GaussianSeed> seedsOver(std::span<const GaussianDisc> discs, unsigned threads);

/// A box, usual radii; empty until it was widened.
struct GaussianRegion {
  Vec3 low{std::numeric_limits<float>::max()}, high{std::numeric_limits<float>::lowest()};

  void widen(const Vec3& place) { low = glm::min(low, place), high = glm::max(high, place); }
  void widen(const GaussianRegion& other) { low = glm::min(low, other.low), high = glm::max(high, other.high); }
  bool meets(const GaussianRegion& other) const {
    return glm::all(glm::lessThan(low, other.high)) && glm::all(glm::lessThan(other.low, high));
  }
};

inline constexpr std::size_t kCellsAtOnce = 64;  ///< taken by a thread at a time: many are nearly empty, some full

/// Seeds by cells of a grid, and the discs that contribute around each cell. Keeps a view of the seeds.
class SeedCells {
 public:
  /// `margin`: how far outside its cell a position may be and still get all contributions there, usual radii.
  SeedCells(std::span<const GaussianDisc> discs, std::span<const GaussianSeed> seeds, float margin, unsigned threads);

  std::size_t count() const { return begins_.size() - 1; }
  struct Range {
    std::size_t begin, end;
  };
  Range seedsOf(std::size_t cell) const { return {begins_[cell], begins_[cell + 1]}; }
  /// The region around a cell in which contributions are complete.
  GaussianRegion withMargin(std::size_t cell) const { return withMargin(cell, level_); }

  /// The cells of a cube of four times the side share this number: their contributing Gaussians largely coincide.
  std::uint64_t cubeOf(std::size_t cell) const { return seeds_[begins_[cell]].voxel >> (3 * cubeLevel()); }
  /// All Gaussians that contribute in the cell's cube or within its margin.
  void collectAround(std::size_t cell, std::vector<FeltGaussian>& felt) const;

 private:
  /// Discs by the cells of their centres, on a grid so coarse that each disc with its margin reaches at most the
  /// adjacent cells; no grid is finer than the cubes.
  struct Grid {
    int level;
    std::size_t firstDisc;
    MortonCells cells;                   // discs are counted from firstDisc
    BareVector<GaussianRegion> regions;  // of each cell: where its discs have an effect
  };
  int finestLevel(std::span<const GaussianDisc> discs, unsigned threads) const;
  void sortDiscs(std::span<const GaussianDisc> discs, unsigned threads);
  int cubeLevel() const { return level_ + 2; }
  GaussianRegion withMargin(std::size_t cell, int level) const;

  std::span<const GaussianSeed> seeds_;
  float margin_;
  int level_;                       // a cell has 2^level voxels along its side
  BareVector<std::size_t> begins_;  // first seed of each cell, and the end of the last
  BareVector<FeltGaussian> felt_;   // all discs, sorted by grid and cell
  std::vector<Grid> grids_;
};

/// Finds the Gaussians that contribute around cells, for one thread: once for consecutive cells of the same cube.
class GaussiansAround {
 public:
  explicit GaussiansAround(const SeedCells& cells) : cells_(cells) {}
  /// Fills `density` with the Gaussians that contribute in the part of `region` within the cell or its margin.
  void gather(std::size_t cell, const GaussianRegion& region, GaussianDensity& density);

 private:
  static constexpr std::size_t kLanes = 16;
  /// Boxes of sixteen Gaussians; empty boxes fill unused lanes.
  struct Boxes {
    std::array<std::array<float, kLanes>, 3> low, high;
  };
  void moveTo(std::size_t cell);
  void chooseIn(const GaussianRegion& region);

  const SeedCells& cells_;
  std::uint64_t cube_ = ~std::uint64_t{0};
  std::vector<FeltGaussian> felt_;
  std::vector<Boxes> boxes_;
  std::vector<std::uint32_t> chosen_;
};

}  // namespace palpate
