// Places spread over the discs of Gaussians, and which Gaussians are felt around each of them.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "engine/cloud/gaussian_density.hpp"
#include "engine/cloud/gaussian_discs.hpp"
#include "engine/cloud/morton_cells.hpp"

namespace palpate {

inline constexpr float kSeedVoxel = 0.85f;  ///< usual radii: the side of the voxels that have one seed each

/// Lengths in usual radii.
struct GaussianSeed {
  std::uint64_t voxel = 0;  ///< Morton code
  Vec3 place{0};
  std::uint32_t disc = 0;

  bool operator<(const GaussianSeed& other) const;
};

/// Over each disc as many as its area asks for, in a spiral of even area (Vogel 1979), no two in one voxel; in the
/// order of the voxels. The result does not depend on `threads`.
std::vector<GaussianSeed> seedsOver(std::span<const GaussianDisc> discs, unsigned threads);

/// Seeds by cells of a grid, and for each cell the discs that reach it. Keeps views of both, which must outlive it.
class SeedCells {
 public:
  /// `margin`: how far outside of its cell a place may be and still feel all that is felt there, usual radii.
  SeedCells(std::span<const GaussianDisc> discs, std::span<const GaussianSeed> seeds, float margin, unsigned threads);

  std::size_t count() const { return cells_.count(); }
  struct Range {
    std::size_t begin, end;
  };
  Range seedsOf(std::size_t cell) const { return {begins_[cell], begins_[cell + 1]}; }
  /// A box, usual radii; nothing is in one that was not widened.
  struct Region {
    Vec3 low{std::numeric_limits<float>::max()}, high{std::numeric_limits<float>::lowest()};
    void widen(const Vec3& place) { low = glm::min(low, place), high = glm::max(high, place); }
  };
  /// Fills `density` with what is felt in the part of `region` that is in the cell or within its margin.
  void gather(std::size_t cell, const Region& region, GaussianDensity& density) const;

 private:
  struct Box {
    IVec3 low, high;  // cells, both included
  };
  Box boxOf(const GaussianDisc& disc) const;
  void divide(unsigned threads);
  void listDiscs(unsigned threads);

  std::span<const GaussianDisc> discs_;
  std::span<const GaussianSeed> seeds_;
  float margin_;
  int level_;  // a cell has 2^level voxels along its side
  MortonCells cells_;
  std::vector<std::size_t> begins_;  // of the cells' seeds, and the end of the last
  std::vector<std::size_t> listBegins_;
  std::vector<std::uint32_t> lists_;  // discs, in their order within a cell
};

}  // namespace palpate
