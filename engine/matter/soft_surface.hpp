// The present surface of a soft body.
#pragma once

#include <span>
#include <vector>

#include "engine/core/worker_team.hpp"
#include "engine/matter/soft_body.hpp"

namespace palpate {

/// Evenly distributed surface positions, about half a cell spacing apart. For any thread while the body does not move.
class SoftSurface {
 public:
  SoftSurface(const SoftLattice& lattice, std::span<const SurfacePlace> surface);

  std::size_t size() const { return rest_.size(); }
  /// Present position, m; its normal, unit, outward.
  Vec3 placeOf(const SoftBody& body, std::size_t i) const;
  Vec3 normalOf(const SoftBody& body, std::size_t i) const;
  /// The surface position nearest to a position, m.
  std::uint32_t nearest(const SoftBody& body, const DVec3& place_m) const;
  /// Present positions of all of them, m.
  void places(const SoftBody& body, std::vector<Vec3>& now, WorkerTeam& team) const;
  /// Nodal forces, N, of a force of 1 N along `direction` distributed evenly over the surface positions within
  /// `radius_m` of a present position, or applied to the nearest one.
  std::vector<DVec3> spread(const SoftBody& body, const DVec3& place_m, double radius_m, const DVec3& direction) const;
  /// Calls visit(node, share) for the corners of a position's cell, with their shares of it.
  template <class Visit>
  void forEachNode(const SoftBody& body, std::size_t i, Visit&& visit) const {
    const SoftLattice::Corners& nodes = body.lattice().corners()[embedded_[i].cell];
    for (int k = 0; k < 8; ++k) visit(nodes[static_cast<std::size_t>(k)], shared::cornerShare(embedded_[i].share, k));
  }

 private:
  std::vector<SurfacePlace> rest_;  // in the lattice
  std::vector<EmbeddedPlace> embedded_;
};

}  // namespace palpate
