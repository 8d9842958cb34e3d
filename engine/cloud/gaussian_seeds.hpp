// Places spread over the discs of Gaussians, and which Gaussians are felt around each of them.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vector_relational.hpp>
#include <limits>
#include <span>
#include <vector>

#include "engine/cloud/gaussian_density.hpp"
#include "engine/cloud/gaussian_discs.hpp"
#include "engine/cloud/morton_cells.hpp"
#include "engine/core/bare_vector.hpp"

namespace palpate {

inline constexpr float kSeedVoxel = 0.85f;  ///< usual radii: the side of the voxels that have one seed each

/// Lengths in usual radii.
struct GaussianSeed {
  std::uint64_t voxel = 0;  ///< Morton code
  Vec3 place{0};
  std::uint32_t disc = 0;
};

/// Over each disc as many as its area asks for, in a spiral of even area (Vogel 1979), no two in one voxel, where the
/// first disc's comes first; in the order of the voxels. The result does not depend on `threads`.
BareVector<GaussianSeed> seedsOver(std::span<const GaussianDisc> discs, unsigned threads);

/// A box, usual radii; nothing is in one that was not widened.
struct GaussianRegion {
  Vec3 low{std::numeric_limits<float>::max()}, high{std::numeric_limits<float>::lowest()};

  void widen(const Vec3& place) { low = glm::min(low, place), high = glm::max(high, place); }
  void widen(const GaussianRegion& other) { low = glm::min(low, other.low), high = glm::max(high, other.high); }
  bool meets(const GaussianRegion& other) const {
    return glm::all(glm::lessThan(low, other.high)) && glm::all(glm::lessThan(other.low, high));
  }
};

inline constexpr std::size_t kCellsAtOnce = 64;  ///< that a thread takes: many hold next to nothing, some very much

/// Seeds by cells of a grid, and the discs that are felt around each cell. Keeps a view of the seeds.
class SeedCells {
 public:
  /// `margin`: how far outside of its cell a place may be and still feel all that is felt there, usual radii.
  SeedCells(std::span<const GaussianDisc> discs, std::span<const GaussianSeed> seeds, float margin, unsigned threads);

  std::size_t count() const { return begins_.size() - 1; }
  struct Range {
    std::size_t begin, end;
  };
  Range seedsOf(std::size_t cell) const { return {begins_[cell], begins_[cell + 1]}; }
  /// Where what is felt around a cell can be asked for.
  GaussianRegion withMargin(std::size_t cell) const { return withMargin(cell, level_); }

  /// The cells of a cube of four times the side have one number: much of what is felt in one of them is felt in others.
  std::uint64_t cubeOf(std::size_t cell) const { return seeds_[begins_[cell]].voxel >> (3 * cubeLevel()); }
  /// All that are felt in the cube that a cell is of, or within its margin.
  void collectAround(std::size_t cell, std::vector<FeltGaussian>& felt) const;

 private:
  /// Discs by the cells that their middles are in, of a grid so coarse that none of them, with the margin around it,
  /// gets farther than into the next cell; none is finer than the cubes.
  struct Grid {
    int level;
    std::size_t firstDisc;
    MortonCells cells;
    BareVector<std::size_t> begins;      // of the cells' discs, counted from the first, and the end of the last
    BareVector<GaussianRegion> regions;  // of each cell: where its discs are felt
  };
  int finestLevel(std::span<const GaussianDisc> discs, unsigned threads) const;
  void sortDiscs(std::span<const GaussianDisc> discs, unsigned threads);
  int cubeLevel() const { return level_ + 2; }
  GaussianRegion withMargin(std::size_t cell, int level) const;

  std::span<const GaussianSeed> seeds_;
  float margin_;
  int level_;                       // a cell has 2^level voxels along its side
  BareVector<std::size_t> begins_;  // of the cells' seeds, and the end of the last
  BareVector<FeltGaussian> felt_;   // of all discs, grid by grid and cell by cell
  std::vector<Grid> grids_;
};

/// Looks for what is felt around cells, for one thread: once for all cells of a cube that come one after the other.
class GaussiansAround {
 public:
  explicit GaussiansAround(const SeedCells& cells) : cells_(cells) {}
  /// Fills `density` with what is felt in the part of `region` that is in the cell or within its margin.
  void gather(std::size_t cell, const GaussianRegion& region, GaussianDensity& density);

 private:
  static constexpr std::size_t kLanes = 16;
  /// Where sixteen Gaussians are felt; nowhere where there are fewer.
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
