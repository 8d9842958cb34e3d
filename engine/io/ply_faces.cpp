#include "engine/io/ply_faces.hpp"

#include <algorithm>

#include "engine/cloud/normals.hpp"
#include "engine/core/error.hpp"
#include "engine/io/polygon.hpp"

namespace palpate {

const PlyProperty* PlyFaces::indexList(const PlyElement& element) {
  if (element.name != "face" && element.name != "tristrips") return nullptr;
  for (const PlyProperty& property : element.properties) {
    const bool named = property.name == "vertex_indices" || property.name == "vertex_index";
    if (named && property.isList && !isFloating(property.type)) return &property;
  }
  return nullptr;
}

const PlyProperty* PlyFaces::coordinateList(const PlyElement& element) {
  const auto found = std::ranges::find(element.properties, "texcoord", &PlyProperty::name);
  return element.name == "face" && found != element.properties.end() && found->isList ? &*found : nullptr;
}

void PlyFaces::addCoordinates(std::span<const std::int64_t> indices, std::span<const double> numbers,
                              std::uint32_t texture) {
  if (numbers.size() != 2 * indices.size()) return;  // MeshLab writes an empty list for a face without a texture
  for (std::size_t k = 0; k < indices.size(); ++k) {
    const auto row = static_cast<std::size_t>(indices[k]);
    if (row >= spots_->size()) spots_->resize(row + 1);
    TextureSpot& spot = (*spots_)[row];
    if (spot.texture == kNoTexture) spot = {texture, Vec2(DVec2(numbers[2 * k], numbers[2 * k + 1]))};
  }
}

std::vector<TextureSpot> PlyFaces::spots(std::span<const std::uint64_t> leftOut) const {
  std::vector<TextureSpot> kept;
  if (!spots_ || spots_->empty()) return kept;
  auto gone = leftOut.begin();
  for (std::uint64_t row = 0; row < vertexCount_; ++row) {
    if (gone != leftOut.end() && *gone == row)
      ++gone;
    else
      kept.push_back(row < spots_->size() ? (*spots_)[row] : TextureSpot{});
  }
  return kept;
}

std::optional<std::string> PlyFaces::add(std::span<const std::int64_t> indices, bool isStrip) {
  for (const std::int64_t index : indices) {
    if (isStrip && index == -1) continue;
    if (index < 0 || static_cast<std::uint64_t>(index) >= vertexCount_)
      return fmt::format("a face names vertex {}, but there are only {}", index, vertexCount_);
  }
  if (!isStrip && indices.size() > 3) polygons_.push_back({triangles_.size(), indices.size() - 2});
  std::size_t start = 0;  // of the polygon or of the current strip
  for (std::size_t k = 0; k < indices.size(); ++k) {
    if (isStrip && indices[k] == -1) {
      start = k + 1;
    } else if (k >= start + 2) {
      const bool flipped = isStrip && (k - start) % 2 == 1;  // strips alternate their winding
      const auto a = static_cast<std::uint64_t>(indices[isStrip ? k - 2 : start]);
      const auto b = static_cast<std::uint64_t>(indices[k - 1]);
      const auto c = static_cast<std::uint64_t>(indices[k]);
      triangles_.push_back(flipped ? std::array{b, a, c} : std::array{a, b, c});
    }
  }
  return std::nullopt;
}

void PlyFaces::cutPolygons(const PointCloud& cloud, std::span<const std::uint64_t> leftOut) {
  std::vector<std::uint64_t> corners;
  std::vector<DVec3> around;
  std::vector<std::array<std::uint32_t, 3>> cut;
  for (const Polygon& polygon : polygons_) {
    corners = {triangles_[polygon.first][0], triangles_[polygon.first][1]};
    for (std::size_t k = 0; k < polygon.triangles; ++k) corners.push_back(triangles_[polygon.first + k][2]);
    around.clear();
    for (const std::uint64_t row : corners) {
      const auto before = std::ranges::lower_bound(leftOut, row);
      if (before != leftOut.end() && *before == row) break;
      around.push_back(cloud.fileCoordinates(row - static_cast<std::uint64_t>(before - leftOut.begin())));
    }
    if (around.size() < corners.size()) continue;
    cut.clear();
    addPolygon(around, cut);
    for (std::size_t k = 0; k < cut.size(); ++k)
      triangles_[polygon.first + k] = {corners[cut[k][0]], corners[cut[k][1]], corners[cut[k][2]]};
  }
}

std::size_t PlyFaces::leaveOut(std::span<const std::uint64_t> rows) {
  if (rows.empty()) return 0;
  const auto gone = std::erase_if(triangles_, [&](const std::array<std::uint64_t, 3>& triangle) {
    return std::ranges::any_of(triangle, [&](std::uint64_t row) { return std::ranges::binary_search(rows, row); });
  });
  for (auto& triangle : triangles_)
    for (std::uint64_t& row : triangle)
      row -= static_cast<std::uint64_t>(std::ranges::lower_bound(rows, row) - rows.begin());
  return gone;
}

void PlyFaces::applyTo(PointCloud& cloud, const std::filesystem::path& file, Log* log) const {
  if (cloud.empty()) return;
  std::vector<DVec3> sums(cloud.size(), DVec3(0));
  for (const auto& [a, b, c] : triangles_) {
    const DVec3 corner(cloud.positions[a]);
    const DVec3 twiceArea = glm::cross(DVec3(cloud.positions[b]) - corner, DVec3(cloud.positions[c]) - corner);
    for (const std::uint64_t index : {a, b, c}) sums[index] += twiceArea;
  }
  std::vector<std::size_t> missing;
  cloud.normals.resize(cloud.size());
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const double length = glm::length(sums[i]);
    if (length > 0 && std::isfinite(length))
      cloud.normals[i] = Vec3(sums[i] / length);
    else
      missing.push_back(i);
  }
  if (missing.size() == cloud.size())
    throw FileError(file, "has no faces with an area to take normals from; estimate them instead");
  if (!missing.empty()) fillMissingNormals(cloud, missing, file.filename().string(), log, 1.0);
}

}  // namespace palpate
