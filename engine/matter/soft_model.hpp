// A soft body as a scene has it at rest: made once, for whoever simulates, feels and shows it.
#pragma once

#include <memory>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "engine/matter/matter_simulation.hpp"
#include "engine/matter/soft_lattice.hpp"

namespace palpate {

struct SoftModel {
  SoftSolid solid;
  std::vector<SurfacePlace>
      points;  ///< of its surface, that it carries: what is felt and seen, in the order of their ids
};

/// `scan`: the points of the scene's model, in their order; of a scene that names no file it is empty, and the shape is
/// made. `threads`: 0: one per core; the same for any number. Throws Error as planOf(), placeScan() and scanSolid() do.
std::shared_ptr<const SoftModel> softModelOf(const MatterScene& scene, PointCloud scan = {}, unsigned threads = 0);

/// That of the options, or else of the scene, which names no file; refused before anything is filled where it takes
/// more memory than they say.
std::shared_ptr<const SoftModel> softModelFor(const MatterScene& scene, const MatterOptions& options);
/// A body that was filled, and what it carries: where there are no points, its skin.
std::shared_ptr<const SoftModel> softModelOf(SoftSolid solid, std::span<const SurfacePlace> points);
/// The solid of such a scene alone.
SoftSolid solidOf(const MatterScene& scene, std::uint64_t memory_bytes = kAnyMemory);

/// The points as a cloud at rest in the scene: mm, with normals, in the order of their ids.
PointCloud cloudOf(const SoftModel& model, const MatterScene& scene);

}  // namespace palpate
