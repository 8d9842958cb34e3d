// The surface of a soft body where it now is.
#pragma once

#include <span>
#include <vector>

#include "engine/core/worker_team.hpp"
#include "engine/matter/soft_body.hpp"

namespace palpate {

/// Places that are evenly spread, about half a spacing of the cells apart. For any thread while the body stands.
class SoftSurface {
 public:
  SoftSurface(const SoftLattice& lattice, std::span<const SurfacePlace> surface);

  std::size_t size() const { return rest_.size(); }
  /// Where a place is, m; its normal there, unit, outward.
  Vec3 placeOf(const SoftBody& body, std::size_t i) const;
  Vec3 normalOf(const SoftBody& body, std::size_t i) const;
  /// The place that is nearest to another one, m.
  std::uint32_t nearest(const SoftBody& body, const DVec3& place_m) const;
  /// Where all of them are, m.
  void places(const SoftBody& body, std::vector<Vec3>& now, WorkerTeam& team) const;
  /// Force of 1 N along `direction` that is spread evenly over the places within `radius_m` of one now, or at the
  /// nearest one, as the nodes have it, N.
  std::vector<DVec3> spread(const SoftBody& body, const DVec3& place_m, double radius_m, const DVec3& direction) const;
  /// visit(node, share): the corners of the cell that a place is in, and their shares of it.
  template <class Visit>
  void forEachNode(const SoftBody& body, std::size_t i, Visit&& visit) const {
    const SoftLattice::Corners& nodes = body.lattice().corners()[embedded_[i].cell];
    for (int k = 0; k < 8; ++k) visit(nodes[static_cast<std::size_t>(k)], shared::cornerShare(embedded_[i].share, k));
  }

 private:
  std::vector<SurfacePlace> rest_;  // as in the lattice
  std::vector<EmbeddedPlace> embedded_;
};

}  // namespace palpate
