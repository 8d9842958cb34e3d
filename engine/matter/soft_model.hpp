// A soft body as a scene has it at rest: made once, for whoever simulates, feels and shows it.
#pragma once

#include <memory>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "engine/matter/matter_scene.hpp"
#include "engine/matter/soft_lattice.hpp"

namespace palpate {

struct SoftModel {
  SoftSolid solid;
  std::vector<SurfacePlace> points;  ///< of its surface, that it carries: what is felt and seen, in the order of their ids
};

/// `scan`: the points of the scene's model, in their order; of a scene that names no file it is empty, and the shape is
/// made. `threads`: 0: one per core; the same for any number. Throws Error as planOf(), placeScan() and scanSolid() do.
std::shared_ptr<const SoftModel> softModelOf(const MatterScene& scene, PointCloud scan = {}, unsigned threads = 0);

/// The points as a cloud at rest in the scene: mm, with normals, in the order of their ids.
PointCloud cloudOf(const SoftModel& model, const MatterScene& scene);

}  // namespace palpate
