// Where the density of Gaussians is that of a sheet, and which of its faces is the outer one.
#pragma once

#include <span>

#include "engine/cloud/gaussian_seeds.hpp"

namespace palpate {

/// What the density is like around a seed. Lengths in usual radii.
struct GaussianSheet {
  Vec3 normal{0};        ///< unit; zero: there is no sheet
  float logDensity = 0;  ///< at the seed
  float toMiddle = 0;    ///< along the normal, to where the density is greatest
  float sharpness = 0;   ///< minus the second derivative of the density's logarithm along the normal, positive

  bool exists() const { return sharpness > 0; }
  void turn() { normal = -normal, toMiddle = -toMiddle; }
};

/// One for each seed. The normal is the direction in which the density falls off fastest, of either sign: of all
/// Gaussians that are felt there, by their places and their shapes. None where it falls off in no direction, as between
/// Gaussians, or where it is next to nothing.
BareVector<GaussianSheet> sheetsAt(const SeedCells& cells, std::span<const GaussianSeed> seeds, unsigned threads);

/// Takes away the sheets that stand apart from all others and are of fewer than eight Gaussians (where there are larger
/// ones), and turns the normals of the others outwards: signs go along places of all sheets, one for each cell of a
/// grid, as orientNormals() has it. Says how many were taken away.
std::size_t orientSheets(std::span<const GaussianSeed> seeds, std::span<GaussianSheet> sheets, unsigned threads);

}  // namespace palpate
