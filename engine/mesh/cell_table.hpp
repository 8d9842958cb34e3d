// The cases of marching cubes, generated from a rule at compile time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace palpate {

/// The triangles of a lattice cell for each of the 256 inside/outside states of its corners (Lorensen and Cline 1987).
/// Corner c is at (c & 1, c >> 1 & 1, c >> 2 & 1); bit c of a case is set if it is inside. Edge e runs along axis e / 4
/// from corner lowCorner(e).
///
/// The rule. In every face of the cell, traversed anticlockwise as seen from outside, each run of inside corners is cut
/// off by a segment, from the edge where the run begins to the edge where it ends. So two diagonally opposite inside
/// corners are cut off separately. This depends only on the four corners of the face, so that both cells of a face
/// agree, and the mesh has no cracks. The segments of a cell form loops, anticlockwise as seen from the outer side. A
/// loop is triangulated without diagonals between two edges of one face: the neighbouring cell could use the same
/// diagonal, and four triangles would share it. Of the remaining triangulations the one with the fattest worst triangle
/// is taken, for vertices at the middle of edges.
///
/// Consequences. Each cut edge of the lattice is a vertex of one loop in each of its four cells, each segment belongs
/// to the two cells of its face, each diagonal to one cell: where all neighbouring cells exist, the mesh is a closed
/// 2-manifold. Vertices lie inside their edges, never at an end, and a line meets the surface of a cube in two points
/// or lies in a face, where no triangle has its three vertices: so no triangle has zero area.
struct CellCase {
  std::uint8_t triangles = 0;
  std::array<std::uint8_t, 15> edges{};  ///< three for each triangle, anticlockwise as seen from outside the surface
};

constexpr unsigned lowCorner(unsigned edge) {
  const unsigned axis = edge / 4, u = (axis + 1) % 3, v = (axis + 2) % 3;
  return (edge & 1u) << u | (edge >> 1 & 1u) << v;
}
constexpr unsigned highCorner(unsigned edge) { return lowCorner(edge) | 1u << edge / 4; }

namespace cell_table {

inline constexpr unsigned kNone = 12;
inline constexpr unsigned kLongestLoop = 7;

constexpr unsigned edgeBetween(unsigned a, unsigned b) {
  for (unsigned edge = 0; edge < 12; ++edge)
    if ((lowCorner(edge) == a && highCorner(edge) == b) || (lowCorner(edge) == b && highCorner(edge) == a)) return edge;
  return kNone;
}

/// The corners of face 0 to 5 (x low, x high, y low, …), anticlockwise as seen from outside the cell.
constexpr std::array<unsigned, 4> faceCorners(unsigned face) {
  const unsigned axis = face / 2, u = 1u << (axis + 1) % 3, v = 1u << (axis + 2) % 3;
  if (face % 2 == 1) return {1u << axis, 1u << axis | u, 1u << axis | u | v, 1u << axis | v};
  return {0, v, u | v, u};
}

constexpr bool shareFace(unsigned edgeA, unsigned edgeB) {
  for (unsigned axis = 0; axis < 3; ++axis) {
    if (axis == edgeA / 4 || axis == edgeB / 4) continue;
    if ((lowCorner(edgeA) >> axis & 1u) == (lowCorner(edgeB) >> axis & 1u)) return true;
  }
  return false;
}

/// For each edge the edge to which its segment leads; kNone if no segment begins there.
constexpr std::array<unsigned, 12> segmentsOf(unsigned inside) {
  std::array<unsigned, 12> next{};
  next.fill(kNone);
  for (unsigned face = 0; face < 6; ++face) {
    const auto corners = faceCorners(face);
    const auto isInside = [&](unsigned k) { return (inside >> corners[k % 4] & 1u) != 0; };
    for (unsigned k = 0; k < 4; ++k) {
      if (isInside(k) || !isInside(k + 1)) continue;
      unsigned last = k + 1;
      while (isInside(last + 1)) ++last;
      next[edgeBetween(corners[k], corners[(k + 1) % 4])] = edgeBetween(corners[last % 4], corners[(last + 1) % 4]);
    }
  }
  return next;
}

/// Four times the squared area over the square of the sum of squared sides, of a triangle with vertices at the middle
/// of its edges.
constexpr double fatness(unsigned edgeA, unsigned edgeB, unsigned edgeC) {
  const auto middle = [](unsigned edge, unsigned axis) {
    return static_cast<double>((lowCorner(edge) >> axis & 1u) + (highCorner(edge) >> axis & 1u)) / 2;
  };
  double ab[3] = {}, ac[3] = {}, sides = 0;
  for (unsigned axis = 0; axis < 3; ++axis) {
    ab[axis] = middle(edgeB, axis) - middle(edgeA, axis);
    ac[axis] = middle(edgeC, axis) - middle(edgeA, axis);
    const double bc = ac[axis] - ab[axis];
    sides += ab[axis] * ab[axis] + ac[axis] * ac[axis] + bc * bc;
  }
  double squared = 0;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const unsigned u = (axis + 1) % 3, v = (axis + 2) % 3;
    const double cross = ab[u] * ac[v] - ab[v] * ac[u];
    squared += cross * cross;
  }
  return squared / (sides * sides);
}

/// Adds the triangles of a loop of `count` edges: finds the best triangulation of each run from those of shorter runs.
constexpr void addLoop(CellCase& cell, const std::array<unsigned, 12>& loop, unsigned count) {
  constexpr double kForbidden = -1, kOpen = 2;
  double worst[kLongestLoop][kLongestLoop] = {};
  unsigned tip[kLongestLoop][kLongestLoop] = {};
  for (unsigned span = 1; span < count; ++span)
    for (unsigned i = 0; i + span < count; ++i) {
      const unsigned j = i + span;
      const bool diagonal = span > 1 && span < count - 1;
      worst[i][j] = span == 1 ? kOpen : kForbidden;
      if (span == 1 || (diagonal && shareFace(loop[i], loop[j]))) continue;
      for (unsigned k = i + 1; k < j; ++k) {
        double least = fatness(loop[i], loop[k], loop[j]);
        if (worst[i][k] < least) least = worst[i][k];
        if (worst[k][j] < least) least = worst[k][j];
        if (least > worst[i][j]) {
          worst[i][j] = least;
          tip[i][j] = k;
        }
      }
    }
  if (worst[0][count - 1] <= 0) throw "this loop has no triangulation by the rule";
  unsigned runs[kLongestLoop * 2][2] = {{0, count - 1}}, open = 1;
  while (open > 0) {
    const unsigned i = runs[open - 1][0], j = runs[open - 1][1];
    --open;
    if (j - i < 2) continue;
    const unsigned k = tip[i][j];
    const std::size_t at = 3u * cell.triangles++;
    cell.edges[at] = static_cast<std::uint8_t>(loop[i]);
    cell.edges[at + 1] = static_cast<std::uint8_t>(loop[k]);
    cell.edges[at + 2] = static_cast<std::uint8_t>(loop[j]);
    runs[open][0] = i, runs[open][1] = k, ++open;
    runs[open][0] = k, runs[open][1] = j, ++open;
  }
}

constexpr CellCase makeCase(unsigned inside) {
  CellCase cell;
  auto next = segmentsOf(inside);
  for (unsigned first = 0; first < 12; ++first) {
    std::array<unsigned, 12> loop{};
    unsigned count = 0;
    for (unsigned edge = first; next[edge] != kNone;) {
      loop[count++] = edge;
      const unsigned following = next[edge];
      next[edge] = kNone;
      edge = following;
    }
    if (count > 0) addLoop(cell, loop, count);
  }
  return cell;
}

constexpr std::array<CellCase, 256> makeAll() {
  std::array<CellCase, 256> all{};
  for (unsigned inside = 0; inside < 256; ++inside) all[inside] = makeCase(inside);
  return all;
}

}  // namespace cell_table

/// Indexed by the bits of the inside corners.
inline constexpr std::array<CellCase, 256> kCellCases = cell_table::makeAll();

static_assert(kCellCases[0].triangles == 0 && kCellCases[255].triangles == 0);
static_assert(kCellCases[1].triangles == 1 && kCellCases[0xfe].triangles == 1);

}  // namespace palpate
