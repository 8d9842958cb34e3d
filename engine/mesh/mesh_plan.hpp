// What is meshed and how: decided on the host, before anything is uploaded.
#pragma once

#include <array>
#include <string_view>
#include <utility>

#include "engine/cloud/point_cloud.hpp"
#include "shaders/shared/mesh.h"

namespace palpate {

/// The implicit function whose zero is the mesh. The first three are the surfaces that are felt, as signed distances:
/// negative inside, so that the mesh is one sheet where the points are, and known up to a support radius on either
/// side, which is more than a cell. `sphere` is the default: unlike `average` it neither shrinks nor grows where the
/// surface is curved, and unlike `sharp` it takes one pass over the points. `density`, the thesis's, needs no normals;
/// it has no inside, so its mesh is a skin around the points with two sheets half a spacing or so off the surface.
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

/// Cells along the longest side at most.
inline constexpr std::uint32_t kFinestLattice = 2048;
/// A support radius covers so many cells at least: all corners of a cell that the surface crosses then have neighbours,
/// however far from a point the surface comes between points that are themselves dense enough.
inline constexpr double kMinRadius_cells = 2.5;

struct MeshOptions {
  std::uint32_t lattice = 128;  ///< cells along the longest side of the cloud's box, 1 to kFinestLattice
  MeshSurface surface = MeshSurface::sphere;
  double radius = 0;  ///< support radius, model units; 0: kSupportSpacings spacings; never below kMinRadius_cells
  double room = 0;    ///< how far points may leave the box in later edits, longest sides
};

struct MeshPlan {
  shared::MeshLattice lattice{};
  MeshSurface surface = MeshSurface::sphere;
  /// Share of the points that are used. Where a support radius holds far more than it needs, because the lattice is
  /// coarse, a part serves as well; a point's number alone decides whether it belongs to it.
  double share = 1;

  bool uses(std::uint32_t point) const;
};

/// `spacing`: meanSpacing() of the cloud, model units; 0 where it has none. Throws Error for a lattice that would need
/// more blocks than can be numbered.
MeshPlan planMesh(const Bounds& bounds, double spacing, const MeshOptions& options);

}  // namespace palpate
