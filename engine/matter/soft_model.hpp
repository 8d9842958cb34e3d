// A soft body at rest in its scene: made once, shared by simulation, touch and drawing.
#pragma once

#include <memory>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "engine/matter/matter_simulation.hpp"
#include "engine/matter/soft_lattice.hpp"

namespace palpate {

struct SoftModel {
  SoftSolid solid;
  std::vector<SurfacePlace> points;  ///< carried surface points, which are felt and drawn, in the order of their ids
};

/// `scan`: the points of the scene's model, in their order; empty for a scene that names no file, whose shape is
/// generated. `threads`: 0: one per core; the result is the same for any number. Throws Error as planOf(), placeScan()
/// and scanSolid() do.
std::shared_ptr<const SoftModel> softModelOf(const MatterScene& scene, PointCloud scan = {}, unsigned threads = 0);

/// The model of the options, or else of the scene, which must name no file; throws before anything is filled if it
/// exceeds the memory limit of the options.
std::shared_ptr<const SoftModel> softModelFor(const MatterScene& scene, const MatterOptions& options);
/// A filled body and the points that it carries; if empty, the points of its skin.
std::shared_ptr<const SoftModel> softModelOf(SoftSolid solid, std::span<const SurfacePlace> points);
/// Only the solid of such a scene.
SoftSolid solidOf(const MatterScene& scene, std::uint64_t memory_bytes = kAnyMemory);

/// The points as a cloud at rest in the scene: mm, with normals, in the order of their ids.
PointCloud cloudOf(const SoftModel& model, const MatterScene& scene);

}  // namespace palpate
