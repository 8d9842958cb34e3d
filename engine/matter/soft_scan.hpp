// Fills scans: turns the hollow cloud of a surface into a solid body.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/vec.hpp"
#include "engine/core/worker_team.hpp"
#include "engine/matter/matter_scene.hpp"
#include "engine/matter/soft_lattice.hpp"

namespace palpate {

/// Winding number of a surface of oriented points around a position: 1 inside a closed surface, 0 outside, and in
/// between if it has holes (Barill, Dickson, Schmidt, Levin, Jacobson 2018, "Fast winding numbers for soups and
/// clouds").
/// A point of a surface that represents an area with its outward normal.
struct OrientedArea {
  Vec3 place{0};
  Vec3 normal{0};  ///< unit
  float area = 0;
};

/// A tree of boxes; a box that is far enough away is approximated by a single dipole. Queries are safe from any thread.
class WindingNumber {
 public:
  explicit WindingNumber(std::vector<OrientedArea> points);

  /// Accurate to some hundredths, less so next to a point, around which its area is taken as a disc.
  double at(const DVec3& place) const;

 private:
  // Nodes precede their descendants; `behind` is the next node that is not a descendant.
  struct Node {
    DVec3 middle{0}, dipole{0};  // middle: centroid by area; dipole: sum of areas times normals
    double radius = 0;           // maximum distance of the points from the middle
    std::uint32_t first = 0, count = 0, behind = 0;
    bool isLeaf = false;
  };
  void build(std::uint32_t first, std::uint32_t count);

  std::vector<OrientedArea> points_;  // in the order of the leaves
  std::vector<Node> nodes_;
};

/// The points of a cloud, in their order, at the position of the scene's body (standOf()): scaled to fit, upright as in
/// the file. Estimates normals if there are none. Throws Error for too few points, or no extent.
std::vector<SurfacePlace> placeScan(PointCloud cloud, const MatterScene& scene, unsigned threads = 0);

/// A scan as cells. `kept`: cells that contain points, ascending; they may be empty.
struct FilledScan {
  LatticeBox box;
  std::vector<std::size_t> kept;
};

/// Fills the interior of a closed surface with cells, by the winding numbers of its points, each of which represents an
/// area derived from its neighbours' distance; identical for any number of threads. Holes up to `widestHole_m` (0:
/// three spacings of the lattice plus three of the points) are closed as by a soap film. Throws an Error that begins
/// with "model:" for a wider hole, with its position and width, for points that cover less than about 0.44 of a closed
/// surface, such as a sheet of terrain, for a surface that is turned inside out, and for one that encloses nothing.
FilledScan fillScan(std::span<const SurfacePlace> points, double spacing_m, double widestHole_m, WorkerTeam& team);
/// The same as a body at rest.
SoftSolid scanSolid(std::span<const SurfacePlace> points, double spacing_m, double widestHole_m, WorkerTeam& team);

}  // namespace palpate
