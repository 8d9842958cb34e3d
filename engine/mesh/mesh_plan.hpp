// Parameters of a mesh, decided on the host before any upload.
#pragma once

#include <array>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "shaders/shared/mesh.h"

namespace palpate {

/// The implicit function whose zero set is the mesh. The first three are the surfaces used for touch, as signed
/// distances: negative inside, so that the mesh is one sheet at the points, and known up to a support radius on either
/// side, which is more than a cell. `sphere` is the default: unlike `average` it neither shrinks nor grows where the
/// surface is curved, and unlike `sharp` it takes one pass over the points. `density`, the thesis's, needs no normals;
/// it has no inside, so its mesh is a skin around the points with two sheets, about half a spacing off the surface.
enum class MeshSurface : std::uint32_t {
  average = shared::kSurfaceAverage,
  sphere = shared::kSurfaceSphere,
  sharp = shared::kSurfaceSharp,
  density = shared::kSurfaceDensity,
};
inline constexpr std::array<std::pair<std::string_view, MeshSurface>, 4> kMeshSurfaces{{
    {"average", MeshSurface::average},
    {"sphere", MeshSurface::sphere},
    {"sharp", MeshSurface::sharp},
    {"density", MeshSurface::density},
}};

/// Maximum number of cells along the longest side.
inline constexpr std::uint32_t kMaxResolution = 2048;
/// Minimum number of cells in a support radius: all corners of a cell that the surface crosses then have neighbours,
/// however far the surface lies from a point, if the points are dense enough.
inline constexpr double kMinRadius_cells = 2.5;

struct MeshOptions {
  std::uint32_t resolution = 128;  ///< cells along the longest side of the cloud's box, 1 to kMaxResolution
  MeshSurface surface = MeshSurface::sphere;
  double radius = 0;  ///< support radius, model units; 0: kSupportSpacings spacings; never below kMinRadius_cells
  double room = 0;    ///< margin for edits: how far points may leave the box, in longest sides
};

struct MeshPlan {
  shared::MeshLattice lattice{};
  MeshSurface surface = MeshSurface::sphere;
  /// Share of the points that is used: on a coarse lattice a support radius holds more points than needed, so a subset
  /// suffices. A point's number alone decides whether it is in the subset.
  double share = 1;
  std::vector<bool> chosen;  ///< the subset of the first points (thinned()); further ones are used by chance

  bool uses(std::uint32_t point) const;
};

/// `spacing`: meanSpacing() of the cloud, model units; 0 if undefined. Throws Error if the lattice needs more blocks
/// than can be numbered.
MeshPlan planMesh(const Bounds& bounds, double spacing, const MeshOptions& options);

/// The plan with a subset of the cloud's points as even as their density permits: dense parts and duplicates are
/// thinned, sparse parts are not. Not for the density, which counts points. Requires normals.
MeshPlan thinned(MeshPlan plan, const PointCloud& cloud);

}  // namespace palpate
