// Point normals from the faces of a mesh, for readers of formats with faces.
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
#include "engine/io/texture.hpp"

namespace palpate {

/// Collects the triangles of face and tristrips elements, which may come before or after the vertices.
class PlyFaces {
 public:
  explicit PlyFaces(std::uint64_t vertexCount) : vertexCount_(vertexCount) {}

  /// The list of `element` that contains vertex indices; null if there is none.
  static const PlyProperty* indexList(const PlyElement& element);

  /// The list of `element` that contains two texture coordinates of each corner; null if there is none.
  static const PlyProperty* coordinateList(const PlyElement& element);

  /// Also collects texture coordinates of faces, each vertex those of its first face.
  void collectCoordinates() { spots_.emplace(); }
  bool collectsCoordinates() const { return spots_.has_value(); }
  /// `numbers`: of a polygon that was added; `texture`: its number.
  void addCoordinates(std::span<const std::int64_t> indices, std::span<const double> numbers, std::uint32_t texture);
  /// By point, without the vertices left out, ascending. Empty if no face had coordinates.
  std::vector<TextureSpot> spots(std::span<const std::uint64_t> leftOut) const;

  /// Adds a polygon, or a row of strips in which -1 starts a new one. Returns an error message for an invalid index.
  std::optional<std::string> add(std::span<const std::int64_t> indices, bool isStrip);

  /// Triangulates polygons of more than three corners in their plane; until then they are fans, which are wrong for
  /// concave polygons. `leftOut`: vertex numbers that are not in the cloud, ascending.
  void cutPolygons(const PointCloud& cloud, std::span<const std::uint64_t> leftOut);

  /// Removes the triangles of vertices that were left out, and renumbers the others. `rows`: the vertices left out,
  /// ascending. Returns the number of removed triangles.
  std::size_t leaveOut(std::span<const std::uint64_t> rows);

  /// Sets each normal to the area-weighted mean of the normals around the point (the sum of the cross products of its
  /// triangles). Points without a face get the normal of the nearest point that has one. Throws Error if there is no
  /// face.
  void applyTo(PointCloud& cloud, const std::filesystem::path& file, Log* log) const;

  /// In the order and winding of the file.
  std::span<const std::array<std::uint64_t, 3>> triangles() const { return triangles_; }

 private:
  /// Consecutive triangles.
  struct Polygon {
    std::size_t first, triangles;
  };

  std::uint64_t vertexCount_;
  std::vector<Polygon> polygons_;  // of more than three corners
  std::vector<std::array<std::uint64_t, 3>> triangles_;
  std::optional<std::vector<TextureSpot>> spots_;  // by vertex, up to the last one that has coordinates
};

}  // namespace palpate
