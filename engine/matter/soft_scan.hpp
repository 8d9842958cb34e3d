// Fills scans: a cloud is hollow, a soft body is not.
#pragma once

#include <span>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/worker_team.hpp"
#include "engine/matter/matter_scene.hpp"
#include "engine/matter/soft_lattice.hpp"

namespace palpate {

/// The points of a cloud where the body of the scene stands (standOf()), in their order: as large as fits, and upright
/// as the file has it. Estimates normals where there are none. Throws Error for fewer than a few points, or no extent.
std::vector<SurfacePlace> placeScan(PointCloud cloud, const MatterScene& scene, unsigned threads = 0);

/// A scan as cells: those with points of it, ascending, may be empty, too.
struct FilledScan {
  LatticeBox box;
  std::vector<std::size_t> kept;
};

/// Fills what a closed surface encloses with cells, by the winding numbers of its points, each of which stands for an
/// area by its neighbours' distance; the same for any number of threads. Holes of up to `widestHole_m` (0: three
/// spacings of the lattice and three of the points) are closed as by a soap film. Throws Error that begins with
/// "model:" for a wider one, with its place and width, for points that are less than some 0.44 of a surface all around,
/// as a sheet of terrain is, for a surface that is turned inside out, and for one that encloses nothing.
FilledScan fillScan(std::span<const SurfacePlace> points, double spacing_m, double widestHole_m, WorkerTeam& team);
/// The same as a body at rest.
SoftSolid scanSolid(std::span<const SurfacePlace> points, double spacing_m, double widestHole_m, WorkerTeam& team);

}  // namespace palpate
