// Signs of normals that were fitted point by point.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include "engine/cloud/up.hpp"
#include "engine/core/bare_vector.hpp"
#include "engine/core/vec.hpp"

namespace palpate {

/// Some neighbours of every point, up to `degree` each.
struct NeighbourGraph {
  static constexpr std::uint32_t kNobody = std::numeric_limits<std::uint32_t>::max();

  std::size_t degree = 0;
  BareVector<std::uint32_t> neighbours;  ///< `degree` for each point; kNobody where there are fewer

  std::span<std::uint32_t> of(std::size_t i) { return {neighbours.data() + i * degree, degree}; }
  std::span<const std::uint32_t> of(std::size_t i) const { return {neighbours.data() + i * degree, degree}; }
  bool hasEdge(std::size_t from, std::uint32_t to) const { return std::ranges::find(of(from), to) != of(from).end(); }
};

/// Orients normals so that neighbours agree: the signs are propagated along a minimum spanning tree of the graph
/// (Hoppe, DeRose, Duchamp, McDonald and Stuetzle 1992, section 3.3). The cost of an edge is the rotation of the
/// normals along it plus the distance of each end from the plane of the other. Two normals agree if one is the mirror
/// image of the other in the plane half-way between their points, as on a circle through both (Koenig and Gumhold 2009,
/// "Consistent propagation of normal orientations in point clouds"), which follows edges and distinguishes the two
/// faces of a sheet. Edges that are three times longer than those around one of their ends come last, and
/// join two parts of 500 points and more only if as many of them agree as along a border, so that points that float
/// between two parts do not connect these. Each connected part then faces outwards
/// (facesInwards()). Without `up`, as for the sheets of Gaussians, most of which float about, all edges join, and the
/// highest point (largest z) of each part faces upwards. The points must be distinct. The result does not depend on
/// `threads` (0: one per core).
void orientNormals(std::span<const Vec3> points, std::span<Vec3> normals, const NeighbourGraph& graph,
                   unsigned threads = 0, std::optional<UpAxis> up = {});

}  // namespace palpate
