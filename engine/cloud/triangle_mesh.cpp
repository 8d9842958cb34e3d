#include "engine/cloud/triangle_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include <glm/common.hpp>

#include "engine/core/error.hpp"

namespace palpate {
namespace {

constexpr std::uint32_t kLeafTriangles = 4;  // smaller leaves cost more boxes than they save triangles

std::uint64_t edgeKey(std::uint32_t a, std::uint32_t b) { return std::uint64_t{std::min(a, b)} << 32 | std::max(a, b); }

double squared(const DVec3& v) { return glm::dot(v, v); }

double squaredDistanceToBox(const DVec3& p, const DVec3& min, const DVec3& max) {
  return squared(p - glm::clamp(p, min, max));
}

}  // namespace

TriangleMesh::TriangleMesh(const std::vector<DVec3>& vertices, const std::vector<Triangle>& triangles) {
  weld(vertices, triangles);
  if (triangles_.empty()) throw Error("the mesh has no triangle with an area");
  nodes_.reserve(triangles_.size());
  build(0, static_cast<std::uint32_t>(triangles_.size()));
  sumNormals();
}

void TriangleMesh::weld(const std::vector<DVec3>& vertices, const std::vector<Triangle>& triangles) {
  std::vector<std::uint32_t> order(vertices.size()), placeOf(vertices.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto key = [&](std::uint32_t i) { return std::tie(vertices[i].x, vertices[i].y, vertices[i].z); };
  std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  for (const std::uint32_t i : order) {
    if (vertices_.empty() || vertices_.back() != vertices[i]) vertices_.push_back(vertices[i]);
    placeOf[i] = static_cast<std::uint32_t>(vertices_.size() - 1);
  }
  for (const Triangle& triangle : triangles) {
    const Triangle welded{placeOf[triangle[0]], placeOf[triangle[1]], placeOf[triangle[2]]};
    const DVec3 ab = vertices_[welded[1]] - vertices_[welded[0]], ac = vertices_[welded[2]] - vertices_[welded[0]];
    // A sliver whose height is lost to rounding has no direction; its neighbours cover its area.
    constexpr double kThinnest = 1e-12;
    const double longest = std::max({squared(ab), squared(ac), squared(ac - ab)});
    if (glm::length(glm::cross(ab, ac)) > kThinnest * longest) triangles_.push_back(welded);
  }
}

void TriangleMesh::sumNormals() {
  vertexNormals_.assign(vertices_.size(), DVec3(0));
  for (const Triangle& t : triangles_) {
    const std::array<DVec3, 3> at{vertices_[t[0]], vertices_[t[1]], vertices_[t[2]]};
    const DVec3 normal = glm::normalize(glm::cross(at[1] - at[0], at[2] - at[0]));
    faceNormals_.push_back(normal);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3, last = (k + 2) % 3;
      vertexNormals_[t[k]] += angleBetween_deg(at[next] - at[k], at[last] - at[k]) * normal;
      edgeNormals_.try_emplace(edgeKey(t[k], t[next]), 0.0).first->second += normal;
    }
  }
  for (DVec3& normal : vertexNormals_)
    if (const double length = glm::length(normal); length > 0) normal /= length;
}

// Splits the run at the median of its longest side; the nodes are stored in traversal order.
std::uint32_t TriangleMesh::build(std::uint32_t first, std::uint32_t count) {
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  const auto begin = triangles_.begin() + first;
  Node node{.min = vertices_[(*begin)[0]], .max = vertices_[(*begin)[0]], .first = first, .count = count};
  for (auto t = begin; t != begin + count; ++t)
    for (const std::uint32_t vertex : *t) {
      node.min = glm::min(node.min, vertices_[vertex]);
      node.max = glm::max(node.max, vertices_[vertex]);
    }
  nodes_.push_back(node);
  if (count <= kLeafTriangles) return index;
  const DVec3 sides = node.max - node.min;
  const int axis = sides.x >= sides.y && sides.x >= sides.z ? 0 : sides.y >= sides.z ? 1 : 2;
  const auto middle = [&](const Triangle& t) {
    return vertices_[t[0]][axis] + vertices_[t[1]][axis] + vertices_[t[2]][axis];
  };
  std::nth_element(begin, begin + count / 2, begin + count,
                   [&](const Triangle& a, const Triangle& b) { return middle(a) < middle(b); });
  build(first, count / 2);
  const std::uint32_t second = build(first + count / 2, count - count / 2);
  nodes_[index].count = 0;
  nodes_[index].second = second;
  return index;
}

TriangleMesh::Foot TriangleMesh::footOn(std::uint32_t triangle, const DVec3& p) const {
  const Triangle& t = triangles_[triangle];
  const std::array<DVec3, 3> at{vertices_[t[0]], vertices_[t[1]], vertices_[t[2]]};
  const DVec3 twiceArea = glm::cross(at[1] - at[0], at[2] - at[0]);
  Foot foot{.triangle = triangle};
  bool inside = true;
  for (int k = 0; k < 3; ++k) {
    const auto next = static_cast<std::size_t>((k + 1) % 3), last = static_cast<std::size_t>((k + 2) % 3);
    foot.shares[k] = glm::dot(glm::cross(at[last] - at[next], p - at[next]), twiceArea) / squared(twiceArea);
    inside = inside && foot.shares[k] > 0;
  }
  const auto placed = [&](const DVec3& shares) {
    Foot result{.triangle = triangle, .shares = shares};
    for (int k = 0; k < 3; ++k) result.position += shares[k] * at[static_cast<std::size_t>(k)];
    result.squaredDistance = squared(p - result.position);
    return result;
  };
  if (inside) return placed(foot.shares);
  Foot best{.squaredDistance = std::numeric_limits<double>::infinity()};
  for (int k = 0; k < 3; ++k) {
    const DVec3& from = at[static_cast<std::size_t>(k)];
    const DVec3 edge = at[static_cast<std::size_t>((k + 1) % 3)] - from;
    const double along = std::clamp(glm::dot(p - from, edge) / squared(edge), 0.0, 1.0);
    DVec3 shares(0);
    shares[k] = 1 - along;
    shares[(k + 1) % 3] = along;
    if (const Foot onEdge = placed(shares); onEdge.squaredDistance < best.squaredDistance) best = onEdge;
  }
  return best;
}

TriangleMesh::Foot TriangleMesh::nearest(const DVec3& p) const {
  Foot best{.squaredDistance = std::numeric_limits<double>::infinity()};
  const auto visit = [&](const auto& self, std::uint32_t index) -> void {
    const Node& node = nodes_[index];
    for (std::uint32_t t = node.first; t < node.first + node.count; ++t)
      if (const Foot foot = footOn(t, p); foot.squaredDistance < best.squaredDistance) best = foot;
    if (node.count) return;
    std::array<std::uint32_t, 2> children{index + 1, node.second};
    std::array<double, 2> away{};
    for (std::size_t k = 0; k < 2; ++k)
      away[k] = squaredDistanceToBox(p, nodes_[children[k]].min, nodes_[children[k]].max);
    const std::size_t nearer = away[0] <= away[1] ? 0 : 1;
    for (const std::size_t k : {nearer, 1 - nearer})
      if (away[k] < best.squaredDistance) self(self, children[k]);
  };
  visit(visit, 0);
  return best;
}

DVec3 TriangleMesh::normalFor(const Foot& foot) const {
  const Triangle& t = triangles_[foot.triangle];
  for (int k = 0; k < 3; ++k) {
    const auto corner = static_cast<std::size_t>(k);
    if (foot.shares[k] == 1) return vertexNormals_[t[corner]];
  }
  for (int k = 0; k < 3; ++k) {
    const auto next = static_cast<std::size_t>((k + 1) % 3), last = static_cast<std::size_t>((k + 2) % 3);
    if (foot.shares[k] == 0) return edgeNormals_.at(edgeKey(t[next], t[last]));
  }
  return faceNormals_[foot.triangle];
}

SurfacePoint TriangleMesh::closest(const DVec3& p) const {
  const Foot foot = nearest(p);
  const Triangle& t = triangles_[foot.triangle];
  DVec3 normal(0);
  for (int k = 0; k < 3; ++k) normal += foot.shares[k] * vertexNormals_[t[static_cast<std::size_t>(k)]];
  const double length = glm::length(normal);
  return {foot.position, length > 0 ? normal / length : faceNormals_[foot.triangle]};
}

double TriangleMesh::signedDistance(const DVec3& p) const {
  const Foot foot = nearest(p);
  return std::copysign(std::sqrt(foot.squaredDistance), glm::dot(p - foot.position, normalFor(foot)));
}

}  // namespace palpate
