#include "engine/cloud/normals.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "engine/cloud/eigen3.hpp"
#include "engine/cloud/places.hpp"
#include "engine/cloud/point_tree.hpp"
#include "engine/core/check.hpp"
#include "engine/core/parallel.hpp"

namespace palpate {
namespace {

/// The nearest points of every point, a fixed number each, nearest first.
struct NeighbourGraph {
  std::size_t degree = 0;
  std::vector<std::uint32_t> neighbours;

  std::span<const std::uint32_t> of(std::size_t i) const { return {neighbours.data() + i * degree, degree}; }
  bool hasEdge(std::size_t from, std::uint32_t to) const {
    const auto list = of(from);
    return std::find(list.begin(), list.end(), to) != list.end();
  }
};

/// Direction of least extent of the points around `center`.
Vec3 planeNormal(const std::vector<Vec3>& points, std::span<const std::uint32_t> around, const Vec3& center) {
  DVec3 mean(0);
  for (const std::uint32_t j : around) mean += DVec3(points[j]) - DVec3(center);
  mean /= static_cast<double>(around.size());
  SymmetricMatrix3 covariance;
  for (const std::uint32_t j : around) covariance.addSquare(DVec3(points[j]) - DVec3(center) - mean);
  return Vec3(eigenSymmetric(covariance).vectors[0]);
}

/// Fits the planes; leaves the neighbours in the graph for the signs.
NeighbourGraph fitPlanes(const std::vector<Vec3>& points, std::vector<Vec3>& normals, unsigned neighbours,
                         unsigned threads) {
  NeighbourGraph graph;
  graph.degree = std::min<std::size_t>(std::max(neighbours, 1u), points.size());
  graph.neighbours.resize(graph.degree * points.size());
  normals.resize(points.size());
  const PointTree tree(points);
  parallelFor(points.size(), threads, [&](std::size_t begin, std::size_t end) {
    std::vector<double> squaredDistances(graph.degree);
    for (std::size_t i = begin; i < end; ++i) {
      const std::span<std::uint32_t> around(graph.neighbours.data() + i * graph.degree, graph.degree);
      const std::size_t found = tree.nearest(points[i], around, squaredDistances);
      PALPATE_CHECK_EQ(found, graph.degree);
      normals[i] = planeNormal(points, around, points[i]);
    }
  });
  return graph;
}

/// Groups of points whose signs hang together. Each point knows whether it is flipped against its group.
class SignGroups {
 public:
  explicit SignGroups(std::size_t count) : parent_(count), flipped_(count, 0) {
    std::iota(parent_.begin(), parent_.end(), 0u);
  }

  /// The root of the group of `i`; afterwards `i` hangs directly below it.
  std::uint32_t root(std::uint32_t i) {
    std::uint32_t top = i;
    std::uint8_t sign = 0;
    while (parent_[top] != top) sign ^= flipped_[top], top = parent_[top];
    while (parent_[i] != top && i != top) {
      const std::uint32_t next = parent_[i];
      const std::uint8_t own = flipped_[i];
      parent_[i] = top;
      flipped_[i] = sign;
      sign ^= own;
      i = next;
    }
    return top;
  }
  bool isFlipped(std::uint32_t i) {
    root(i);
    return flipped_[i] != 0;
  }
  /// Joins the groups of `a` and `b` so that their signs differ if `differ` says so; nothing if they are one already.
  void join(std::uint32_t a, std::uint32_t b, bool differ) {
    const std::uint32_t rootA = root(a), rootB = root(b);
    if (rootA == rootB) return;
    parent_[rootB] = rootA;
    flipped_[rootB] = static_cast<std::uint8_t>((flipped_[a] ^ flipped_[b] ^ (differ ? 1 : 0)) & 1);
  }

 private:
  std::vector<std::uint32_t> parent_;
  std::vector<std::uint8_t> flipped_;  // against the parent; 0 for roots
};

/// Kruskal's algorithm over edges sorted by how much the normals turn. The turn is rounded to a byte, which makes the
/// sort one counting pass and changes the tree only among edges that are as good as each other.
void joinAlongSmallTurns(const std::vector<Vec3>& normals, const NeighbourGraph& graph, SignGroups& groups) {
  constexpr int kClasses = 256;
  const auto turnClass = [&](std::size_t i, std::uint32_t j) {
    const float turn = 1.0f - std::min(1.0f, std::abs(glm::dot(normals[i], normals[j])));
    return static_cast<int>(std::sqrt(turn) * (kClasses - 1));
  };
  const auto forEachEdge = [&](auto&& body) {
    for (std::size_t i = 0; i < normals.size(); ++i) {
      for (const std::uint32_t j : graph.of(i)) {
        const bool seenFromOtherEnd = j <= i && (j == i || graph.hasEdge(j, static_cast<std::uint32_t>(i)));
        if (!seenFromOtherEnd) body(i, j);
      }
    }
  };
  std::vector<std::size_t> start(kClasses + 1, 0);
  forEachEdge([&](std::size_t i, std::uint32_t j) { ++start[turnClass(i, j) + 1]; });
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges(start.back());
  forEachEdge([&](std::size_t i, std::uint32_t j) {
    edges[start[turnClass(i, j)]++] = {static_cast<std::uint32_t>(i), j};
  });
  for (const auto& [i, j] : edges) groups.join(i, j, glm::dot(normals[i], normals[j]) < 0);
}

/// Turns each group so that its highest point looks upwards.
void applySigns(const std::vector<Vec3>& points, std::vector<Vec3>& normals, SignGroups& groups) {
  std::vector<std::uint32_t> highest(points.size());
  std::iota(highest.begin(), highest.end(), 0u);
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    std::uint32_t& best = highest[groups.root(i)];
    if (points[i].z > points[best].z) best = i;
  }
  std::vector<std::uint8_t> turnGroup(points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (groups.root(i) != i) continue;
    const std::uint32_t top = highest[i];
    const bool looksDown = normals[top].z < 0;
    turnGroup[i] = looksDown != groups.isFlipped(top);
  }
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const bool turn = (turnGroup[groups.root(i)] != 0) != groups.isFlipped(i);
    if (turn) normals[i] = -normals[i];
  }
}

}  // namespace

void estimateNormals(PointCloud& cloud, unsigned neighbours, unsigned threads) {
  const Places places = distinctPlaces(cloud.positions);
  std::vector<Vec3> normals;
  const NeighbourGraph graph = fitPlanes(places.positions, normals, neighbours, threads);
  SignGroups groups(normals.size());
  joinAlongSmallTurns(normals, graph, groups);
  applySigns(places.positions, normals, groups);
  cloud.normals.resize(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) cloud.normals[i] = normals[places.placeOf[i]];
}

void fillMissingNormals(PointCloud& cloud, std::span<const std::size_t> missing, std::string_view cloudName, Log* log,
                        double mostMissing) {
  const auto total = static_cast<double>(cloud.size());
  if (missing.size() == cloud.size() || static_cast<double>(missing.size()) > mostMissing * total) {
    if (log) log->say("{}: {} of {} normals are zero; all are ignored", cloudName, missing.size(), cloud.size());
    cloud.normals.clear();
    return;
  }
  std::vector<bool> isMissing(cloud.size(), false);
  for (const std::size_t i : missing) isMissing[i] = true;
  std::vector<Vec3> known, knownNormals;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (isMissing[i]) continue;
    known.push_back(cloud.positions[i]);
    knownNormals.push_back(cloud.normals[i]);
  }
  const Places places = distinctPlaces(known);
  std::vector<Vec3> normalAt(places.positions.size());
  for (std::size_t i = 0; i < known.size(); ++i) normalAt[places.placeOf[i]] = knownNormals[i];
  const PointTree tree(places.positions);
  for (const std::size_t i : missing) {
    std::uint32_t nearest = 0;
    double squaredDistance = 0;
    tree.nearest(cloud.positions[i], {&nearest, 1}, {&squaredDistance, 1});
    cloud.normals[i] = normalAt[nearest];
  }
  if (log)
    log->say("{}: {} of {} points have no normal and take their nearest neighbour's", cloudName, missing.size(),
             cloud.size());
}

}  // namespace palpate
