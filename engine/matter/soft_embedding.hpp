// Points carried by a soft body: a deformable scan.
#pragma once

#include <span>
#include <vector>

#include "engine/core/cloud_frame.hpp"
#include "engine/matter/soft_body.hpp"

namespace palpate {

/// A point moves with the nodes of its cell, by its share of each at rest; at rest it is exactly at its original
/// position. Normals are transformed by F^-T, with deformation gradients interpolated between nodes, so that they are
/// continuous across the cells' faces.
class SoftEmbedding {
 public:
  SoftEmbedding(const SoftLattice& lattice, std::span<const SurfacePlace> points);

  std::size_t size() const { return places_.size(); }
  /// Positions in m, unit normals and velocities in m/s of all points.
  void carry(const SoftBody& body, CloudFrame& frame, WorkerTeam& team);

 private:
  std::vector<SurfacePlace> rest_;
  std::vector<EmbeddedPlace> places_;
  std::vector<glm::mat3> gradients_;  // per node
};

}  // namespace palpate
