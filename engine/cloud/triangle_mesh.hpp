// A triangle mesh as ground truth of a surface: exact closest points in double precision.
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "engine/cloud/analytic_shape.hpp"

namespace palpate {

/// Coincident corners are merged into one vertex, and triangles without area are dropped. Queries are safe from any
/// thread.
class TriangleMesh {
 public:
  using Triangle = std::array<std::uint32_t, 3>;

  /// Model units; faces wind anticlockwise seen from outside. Throws Error if no triangle has an area.
  TriangleMesh(const std::vector<DVec3>& vertices, const std::vector<Triangle>& triangles);

  std::size_t triangleCount() const { return triangles_.size(); }

  /// The point of the mesh closest to `p`. Its normal is that of the smooth surface that the mesh represents: the
  /// interpolated normals of the corners.
  SurfacePoint closest(const DVec3& p) const;

  /// Distance to the mesh, positive outside. The sign is given by the normal of the closest face, edge or vertex,
  /// vertex normals weighted by angle, which is correct everywhere on a closed mesh (Baerentzen and Aanaes 2005).
  double signedDistance(const DVec3& p) const;

 private:
  // A box over a run of triangles, or over two boxes: the next one and `second`.
  struct Node {
    DVec3 min, max;
    std::uint32_t first = 0, count = 0, second = 0;
  };
  // Closest point on a triangle: its barycentric coordinates, exactly zero on a border.
  struct Foot {
    std::uint32_t triangle = 0;
    DVec3 shares{0}, position{0};
    double squaredDistance = 0;
  };

  void weld(const std::vector<DVec3>& vertices, const std::vector<Triangle>& triangles);
  void sumNormals();
  std::uint32_t build(std::uint32_t first, std::uint32_t count);
  Foot footOn(std::uint32_t triangle, const DVec3& p) const;
  Foot nearest(const DVec3& p) const;
  DVec3 normalFor(const Foot& foot) const;

  std::vector<DVec3> vertices_, vertexNormals_;  // the normals are weighted by angle, unit
  std::vector<Triangle> triangles_;
  std::vector<DVec3> faceNormals_;                        // unit
  std::unordered_map<std::uint64_t, DVec3> edgeNormals_;  // keyed by both vertices; not normalised
  std::vector<Node> nodes_;
};

}  // namespace palpate
