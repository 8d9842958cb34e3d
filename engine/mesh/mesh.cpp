#include "engine/mesh/mesh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "engine/core/stop_checks.hpp"
#include "engine/io/cloud_formats.hpp"

namespace palpate {

namespace {

/// A side of a triangle: its vertices in ascending order, and whether it runs in the opposite direction.
struct Side {
  std::uint32_t low, high;
  bool against;
};

/// Disjoint sets (Galler and Fischer 1964).
class Parts {
 public:
  explicit Parts(std::size_t count) : parents_(count) { std::iota(parents_.begin(), parents_.end(), 0u); }
  std::uint32_t of(std::uint32_t i) {
    while (parents_[i] != i) i = parents_[i] = parents_[parents_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) { parents_[of(a)] = of(b); }

 private:
  std::vector<std::uint32_t> parents_;
};

void countEdges(std::vector<Side>& sides, MeshReport& report) {
  StopChecks check;
  std::ranges::sort(sides, [&check](const Side& a, const Side& b) {
    check();
    return a.low != b.low ? a.low < b.low : a.high != b.high ? a.high < b.high : a.against < b.against;
  });
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i + 1;
    while (end < sides.size() && sides[end].low == sides[i].low && sides[end].high == sides[i].high) ++end;
    ++report.edges;
    if (end - i == 1) ++report.borderEdges;
    if (end - i > 2) ++report.crowdedEdges;
    if (end - i == 2 && sides[i].against == sides[i + 1].against) ++report.turnedEdges;
    i = end;
  }
}

}  // namespace

MeshReport examine(const Mesh& mesh) {
  const auto& positions = mesh.vertices.positions;
  MeshReport report{.vertices = positions.size(), .triangles = mesh.triangles.size()};
  std::vector<Side> sides;
  sides.reserve(3 * mesh.triangles.size());
  Parts parts(positions.size());
  std::vector<bool> used(positions.size());
  const DVec3 about = positions.empty() ? DVec3(0) : DVec3(positions[0]);  // keeps the terms of the volume small
  StopChecks check;
  for (const auto& triangle : mesh.triangles) {
    check();
    std::array<DVec3, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangle[k], b = triangle[(k + 1) % 3];
      sides.push_back({std::min(a, b), std::max(a, b), a > b});
      parts.join(a, b);
      used[a] = true;
      corners[k] = DVec3(positions[a]) - about;
    }
    const DVec3 twiceArea = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    if (!(glm::length(twiceArea) > 0)) ++report.flat;
    report.area += glm::length(twiceArea) / 2;
    report.volume += glm::dot(corners[0], glm::cross(corners[1], corners[2])) / 6;
  }
  countEdges(sides, report);
  for (std::uint32_t i = 0; i < positions.size(); ++i) {
    report.unused += !used[i];
    report.parts += used[i] && parts.of(i) == i;
  }
  return report;
}

std::vector<std::string> lostInMeshFile(const std::filesystem::path& file, const Mesh& mesh) {
  return cloudFormats().toWrite(file, Written::mesh).lacks(mesh.vertices);
}

void writeMesh(const std::filesystem::path& file, const Mesh& mesh, double cell, bool ascii,
               std::filesystem::path* keptAs) {
  cloudFormats().toWrite(file, Written::mesh);  // refuses formats that cannot hold triangles
  const PointCloud& vertices = mesh.vertices;
  double farthest = 0;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const DVec3 place = vertices.fileCoordinates(i);
    for (int k = 0; k < 3; ++k) farthest = std::max(farthest, std::abs(place[k]));
  }
  constexpr double kFinest = 1e-3;  // of a cell
  const bool wide = farthest * static_cast<double>(std::numeric_limits<float>::epsilon()) > kFinest * cell;
  writeCloud(file, vertices, {.ascii = ascii, .triangles = &mesh.triangles, .doubles = wide, .keptAs = keptAs});
}

}  // namespace palpate
