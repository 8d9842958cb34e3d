// Points that a soft body carries along: a scan that bends.
#pragma once

#include <span>
#include <vector>

#include "engine/core/cloud_frame.hpp"
#include "engine/matter/soft_body.hpp"

namespace palpate {

/// A point goes where the nodes of its cell go, by its share of each at rest; at rest it is where it was, to the bit.
/// Normals are turned and stretched by F^-T, with deformation gradients that are blended from node to node, so that
/// they have no edges at the cells' faces.
class SoftEmbedding {
 public:
  SoftEmbedding(const SoftLattice& lattice, std::span<const SurfacePlace> points);

  std::size_t size() const { return places_.size(); }
  /// Positions in m, unit normals and velocities in m/s of all points.
  void carry(const SoftBody& body, CloudFrame& frame, WorkerTeam& team);

 private:
  std::vector<SurfacePlace> rest_;
  std::vector<EmbeddedPlace> places_;
  std::vector<glm::mat3> gradients_;  // of the nodes
};

}  // namespace palpate
