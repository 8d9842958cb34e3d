// Soft bodies for the tests, and their relaxation to rest.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>

#include "engine/matter/soft_body.hpp"
#include "tests/matter/matter_scenes.hpp"

namespace palpate {

inline constexpr double kSoftSpacing_m = 0.005;

/// A body with its lattice.
struct TestBody {
  SoftSolid solid;
  SoftMaterial material;
  SoftBody body;
  double step_s;
  WorkerTeam team{2};

  TestBody(SoftSolid made, const SoftMaterial& of, std::span<const PlaceBox> pinned = {})
      : solid(std::move(made)),
        material(of),
        body(solid.lattice, material, pinned),
        step_s(longestSubstep(of, solid.lattice.spacing_m(), 0)) {}

  SoftSums substep(const DVec3& gravity_m_s2 = DVec3(0)) { return body.substep(gravity_m_s2, step_s, team); }

  /// Relaxes to rest under loads, critically damped for the slowest motion, given by its angular frequency.
  void relax(double slowest_rad_s, const std::function<void(std::span<Vec3>)>& load,
             const DVec3& gravity_m_s2 = DVec3(0)) {
    const double perSubstep = slowest_rad_s * step_s;
    const auto kept = static_cast<float>(std::exp(-2 * perSubstep));
    for (int k = 0; k < 16 / perSubstep; ++k) {
      load(body.loads());
      substep(gravity_m_s2);
      for (Vec3& velocity : body.velocities()) velocity *= kept;
    }
  }
};

/// Nodes whose rest position is in a box.
inline std::vector<std::size_t> nodesIn(const SoftLattice& lattice, const PlaceBox& box) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < lattice.nodes(); ++i)
    if (box.holds(DVec3(lattice.rest()[i]))) found.push_back(i);
  return found;
}

/// A thin sheet at x (m), unbounded in y and z.
inline PlaceBox sheetAt(double x_m) { return {DVec3(x_m - 1e-6, -1e3, -1e3), DVec3(x_m + 1e-6, 1e3, 1e3)}; }

/// Fraction of a face's load for each of its nodes: a quarter of the others at corners and half at edges.
inline std::vector<double> faceShares(const SoftLattice& lattice, std::span<const std::size_t> face) {
  std::vector<double> shares;
  double all = 0;
  for (const std::size_t node : face) {
    double cells = 0;
    for (const auto& corners : lattice.corners()) cells += std::ranges::count(corners, node) > 0 ? 1 : 0;
    shares.push_back(cells);
    all += cells;
  }
  for (double& share : shares) share /= all;
  return shares;
}

}  // namespace palpate
