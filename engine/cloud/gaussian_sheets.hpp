// Sheets in the density of Gaussians, and their outer faces.
#pragma once

#include <span>

#include "engine/cloud/gaussian_seeds.hpp"

namespace palpate {

/// The density around a seed. Lengths in usual radii.
struct GaussianSheet {
  Vec3 normal{0};        ///< unit; zero if there is no sheet
  float logDensity = 0;  ///< at the seed
  float toMiddle = 0;    ///< along the normal, to the density's maximum
  float sharpness = 0;   ///< minus the second derivative of the density's logarithm along the normal; positive

  bool exists() const { return sharpness > 0; }
  void turn() { normal = -normal, toMiddle = -toMiddle; }
};

/// One sheet for each seed. The normal is the direction in which the density falls off fastest, of either sign, from
/// the positions and shapes of all Gaussians that contribute there. No sheet if the density does not fall off in any
/// direction, as between Gaussians, or is nearly zero.
BareVector<GaussianSheet> sheetsAt(const SeedCells& cells, std::span<const GaussianSeed> seeds, unsigned threads);

/// Removes the sheets that are isolated and consist of fewer than eight Gaussians (if there are larger ones), and
/// orients the normals of the others outwards: signs propagate along one position for each cell of a grid, as in
/// orientNormals(). Returns the number of removed sheets.
std::size_t orientSheets(std::span<const GaussianSeed> seeds, std::span<GaussianSheet> sheets, unsigned threads);

}  // namespace palpate
