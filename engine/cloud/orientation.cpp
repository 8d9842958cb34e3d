#include "engine/cloud/orientation.hpp"

#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "engine/core/parallel.hpp"
#include "engine/core/stop_checks.hpp"
#include "engine/core/worker_team.hpp"

namespace palpate {
namespace {

/// Groups of points with known relative signs. Each point knows whether it is flipped against its group.
class SignGroups {
 public:
  explicit SignGroups(std::size_t count) : parent_(count), flipped_(count, 0) {
    std::iota(parent_.begin(), parent_.end(), 0u);
  }

  /// The root of the group of `i`; afterwards `i` is a direct child of it.
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
  /// Joins the groups of `a` and `b` so that their signs differ if `differ` is set; does nothing if they are already
  /// joined.
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

constexpr std::size_t kClasses = 256;

/// An edge of the spanning tree. The cost is rounded to a byte, which makes the sort one counting pass and changes the
/// tree only among edges of about equal cost.
struct Edge {
  std::size_t costClass;
  bool differ;  ///< whether the current normals disagree
};

Edge edgeBetween(std::span<const Vec3> points, std::span<const Vec3> normals, std::size_t i, std::size_t j) {
  const Vec3 along = glm::normalize(points[j] - points[i]);
  const float offI = glm::dot(normals[i], along), offJ = glm::dot(normals[j], along);
  const float agreement = glm::dot(normals[i], normals[j]) - 2 * offI * offJ;
  const float turn = std::sqrt(1 - std::min(1.0f, std::abs(agreement)));
  const float cost = std::max({turn, std::abs(offI), std::abs(offJ)});
  return {static_cast<std::size_t>(std::min(cost, 1.0f) * (kClasses - 1)), agreement < 0};
}

using EdgeEnds = std::array<std::uint32_t, 2>;
constexpr std::uint32_t kDiffer = 1u << 31;  // in the second end; clouds hold fewer points than that

/// The edges of the graph, each once, by cost and then by their points.
std::vector<EdgeEnds> edgesByCost(std::span<const Vec3> points, std::span<const Vec3> normals,
                                  const NeighbourGraph& graph, unsigned threads) {
  constexpr std::size_t kChunk = 1 << 15;
  const std::size_t chunks = (points.size() + kChunk - 1) / kChunk;
  const auto forEachEdge = [&](std::size_t chunk, auto&& body) {
    for (std::size_t i = chunk * kChunk; i < std::min(points.size(), (chunk + 1) * kChunk); ++i)
      for (const std::uint32_t j : graph.of(i)) {
        if (j == NeighbourGraph::kNobody || j == i) continue;
        const bool seenFromOtherEnd = j < i && graph.hasEdge(j, static_cast<std::uint32_t>(i));
        if (!seenFromOtherEnd) body(static_cast<std::uint32_t>(i), j, edgeBetween(points, normals, i, j));
      }
  };
  WorkerTeam team(threads);
  std::vector<std::array<std::size_t, kClasses>> next(chunks);  // first counts, then the index of a chunk's next edge
  team.forEach(chunks, [&](std::size_t chunk) {
    next[chunk].fill(0);
    forEachEdge(chunk, [&](std::uint32_t, std::uint32_t, const Edge& edge) { ++next[chunk][edge.costClass]; });
  });
  std::size_t total = 0;
  for (std::size_t costClass = 0; costClass < kClasses; ++costClass)
    for (auto& chunk : next) total += std::exchange(chunk[costClass], total);
  std::vector<EdgeEnds> edges(total);
  team.forEach(chunks, [&](std::size_t chunk) {
    forEachEdge(chunk, [&](std::uint32_t i, std::uint32_t j, const Edge& edge) {
      edges[next[chunk][edge.costClass]++] = {i, j | (edge.differ ? kDiffer : 0)};
    });
  });
  return edges;
}

/// For each point whether its normal is flipped, so that each group's highest point faces upwards.
std::vector<std::uint8_t> turnsOf(std::span<const Vec3> points, std::span<const Vec3> normals, SignGroups& groups) {
  const auto count = static_cast<std::uint32_t>(points.size());
  std::vector<std::uint32_t> highest(count);
  std::iota(highest.begin(), highest.end(), 0u);
  StopChecks checks;
  for (std::uint32_t i = 0; i < count; ++i) {
    checks();
    std::uint32_t& best = highest[groups.root(i)];
    if (points[i].z > points[best].z) best = i;
  }
  std::vector<std::uint8_t> turns(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t top = highest[groups.root(i)];
    const bool groupTurns = (normals[top].z < 0) != groups.isFlipped(top);
    turns[i] = groupTurns != groups.isFlipped(i);
  }
  return turns;
}

}  // namespace

void orientNormals(std::span<const Vec3> points, std::span<Vec3> normals, const NeighbourGraph& graph,
                   unsigned threads) {
  SignGroups groups(points.size());
  StopChecks checks;
  for (const EdgeEnds& edge : edgesByCost(points, normals, graph, threads)) {  // Kruskal's algorithm
    checks();
    groups.join(edge[0], edge[1] & ~kDiffer, (edge[1] & kDiffer) != 0);
  }
  const std::vector<std::uint8_t> turns = turnsOf(points, normals, groups);
  for (std::size_t i = 0; i < normals.size(); ++i)
    if (turns[i]) normals[i] = -normals[i];
}

}  // namespace palpate
