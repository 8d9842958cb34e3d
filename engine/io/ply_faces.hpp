// Point normals from the faces of a mesh, for readers that meet one.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/log.hpp"
#include "engine/io/ply_header.hpp"

namespace palpate {

/// Collects the triangles of face and tristrips elements, which may come before or after the vertices.
class PlyFaces {
 public:
  explicit PlyFaces(std::uint64_t vertexCount) : vertexCount_(vertexCount) {}

  /// The list of `element` that holds vertex indices; null when it has none.
  static const PlyProperty* indexList(const PlyElement& element);

  /// Adds one polygon, or one row of strips in which -1 starts a new one. Says what is wrong with an index.
  std::optional<std::string> add(std::span<const std::int64_t> indices, bool isStrip);

  /// Cuts polygons of more than three corners in the plane that they lie in; before that they are fans, which are wrong
  /// where corners point inwards. `leftOut`: numbers of vertices that are not in the cloud, in order.
  void cutPolygons(const PointCloud& cloud, std::span<const std::uint64_t> leftOut);

  /// Takes the triangles of vertices that are left out away, and counts the others' vertices without them. `rows`: of
  /// those, in order. How many triangles are gone.
  std::size_t leaveOut(std::span<const std::uint64_t> rows);

  /// Area-weighted mean of the normals around each point (the cross products of its triangles, summed). Points that no
  /// face uses get the normal of the nearest point that has one. Throws Error when there is no face.
  void applyTo(PointCloud& cloud, const std::filesystem::path& file, Log* log) const;

  /// In the order of the file, wound as there.
  std::span<const std::array<std::uint64_t, 3>> triangles() const { return triangles_; }

 private:
  /// Triangles that follow one another.
  struct Polygon {
    std::size_t first, triangles;
  };

  std::uint64_t vertexCount_;
  std::vector<Polygon> polygons_;  // of more than three corners
  std::vector<std::array<std::uint64_t, 3>> triangles_;
};

}  // namespace palpate
