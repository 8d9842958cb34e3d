// The cases of marching cubes: every lattice of signs gives a closed manifold.
#include "engine/mesh/cell_table.hpp"

#include <doctest/doctest.h>

#include <map>
#include <random>
#include <set>

#include "engine/mesh/mesh.hpp"
#include "shaders/shared/mesh.h"

namespace palpate::cell_table_test {

namespace {

bool isCut(unsigned inside, unsigned edge) {
  return (inside >> lowCorner(edge) & 1u) != (inside >> highCorner(edge) & 1u);
}

DVec3 middleOf(unsigned edge) {
  return 0.5 * (DVec3(shared::cornerOffset(lowCorner(edge))) + DVec3(shared::cornerOffset(highCorner(edge))));
}

// The mesh of a lattice of side^3 signs with vertices at the middle of edges; the border of the lattice is outside.
Mesh meshOf(unsigned side, const std::vector<bool>& insides) {
  Mesh mesh;
  std::map<std::size_t, std::uint32_t> vertexOf;
  const auto number = [&](const UVec3& node) { return (std::size_t{node.z} * side + node.y) * side + node.x; };
  for (std::uint32_t z = 0; z + 1 < side; ++z)
    for (std::uint32_t y = 0; y + 1 < side; ++y)
      for (std::uint32_t x = 0; x + 1 < side; ++x) {
        const UVec3 cell(x, y, z);
        unsigned inside = 0;
        for (unsigned corner = 0; corner < 8; ++corner)
          inside |= insides[number(cell + shared::cornerOffset(corner))] ? 1u << corner : 0u;
        const auto vertexOn = [&](unsigned edge) {
          const std::size_t key = 3 * number(cell + shared::cornerOffset(lowCorner(edge))) + edge / 4;
          const auto [entry, isNew] = vertexOf.try_emplace(key, static_cast<std::uint32_t>(mesh.vertices.size()));
          if (isNew) mesh.vertices.positions.emplace_back(DVec3(cell) + middleOf(edge));
          return entry->second;
        };
        const CellCase& found = kCellCases[inside];
        for (std::size_t t = 0; t < found.triangles; ++t)
          mesh.triangles.push_back(
              {vertexOn(found.edges[3 * t]), vertexOn(found.edges[3 * t + 1]), vertexOn(found.edges[3 * t + 2])});
      }
  return mesh;
}

}  // namespace

TEST_CASE("a marching cubes case uses exactly the cut edges, and no triangle lies in a face of the cell") {
  for (unsigned inside = 0; inside < 256; ++inside) {
    CAPTURE(inside);
    const CellCase& found = kCellCases[inside];
    std::set<unsigned> used, cut;
    for (unsigned edge = 0; edge < 12; ++edge)
      if (isCut(inside, edge)) cut.insert(edge);
    for (std::size_t t = 0; t < found.triangles; ++t) {
      const unsigned a = found.edges[3 * t], b = found.edges[3 * t + 1], c = found.edges[3 * t + 2];
      used.insert({a, b, c});
      CHECK(glm::length(glm::cross(middleOf(b) - middleOf(a), middleOf(c) - middleOf(a))) > 0.1);
      for (int axis = 0; axis < 3; ++axis)
        for (const double face : {0.0, 1.0})
          CHECK_FALSE((middleOf(a)[axis] == face && middleOf(b)[axis] == face && middleOf(c)[axis] == face));
    }
    CHECK(used == cut);
  }
}

TEST_CASE("with one corner inside, or all but one, the triangle faces away from the inside") {
  for (unsigned corner = 0; corner < 8; ++corner)
    for (const bool only : {true, false}) {
      const CellCase& found = kCellCases[only ? 1u << corner : 255u ^ 1u << corner];
      REQUIRE(found.triangles == 1);
      const DVec3 a = middleOf(found.edges[0]), b = middleOf(found.edges[1]), c = middleOf(found.edges[2]);
      const double towards = glm::dot(glm::cross(b - a, c - a), a - DVec3(shared::cornerOffset(corner)));
      CHECK((towards > 0) == only);
    }
}

TEST_CASE("any lattice of signs gives a closed mesh: each edge has two triangles of opposite direction") {
  for (const double share : {0.05, 0.2, 0.5, 0.8}) {
    CAPTURE(share);
    constexpr unsigned kSide = 24;
    std::mt19937 random(7);
    std::bernoulli_distribution isInside(share);
    std::vector<bool> insides(kSide * kSide * kSide);
    for (unsigned z = 1; z + 1 < kSide; ++z)
      for (unsigned y = 1; y + 1 < kSide; ++y)
        for (unsigned x = 1; x + 1 < kSide; ++x) insides[(z * kSide + y) * kSide + x] = isInside(random);
    const Mesh mesh = meshOf(kSide, insides);
    const MeshReport report = examine(mesh);
    CHECK(report.triangles > 1000);
    CHECK(report.closed());
    CHECK(report.flat == 0);
    CHECK(report.unused == 0);
    CHECK(report.volume > 0);
    // The triangles around a vertex form one fan: a manifold, not two that touch.
    std::map<std::uint32_t, std::map<std::uint32_t, std::uint32_t>> nextAround;
    for (const auto& t : mesh.triangles)
      for (std::size_t k = 0; k < 3; ++k) nextAround[t[k]][t[(k + 1) % 3]] = t[(k + 2) % 3];
    for (const auto& [vertex, next] : nextAround) {
      std::size_t steps = 0;
      std::uint32_t at = next.begin()->first;
      do {
        at = next.at(at);
        ++steps;
      } while (at != next.begin()->first && steps <= next.size());
      REQUIRE(steps == next.size());
    }
  }
}

}  // namespace palpate::cell_table_test
