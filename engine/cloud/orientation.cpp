#include "engine/cloud/orientation.hpp"

#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "engine/cloud/outward.hpp"
#include "engine/core/bare_vector.hpp"
#include "engine/core/parallel_collect.hpp"
#include "engine/core/stop_checks.hpp"
#include "engine/core/worker_team.hpp"

namespace palpate {
namespace {

/// Groups of points with known relative signs. Each point knows whether it is flipped against its group.
class SignGroups {
 public:
  explicit SignGroups(std::size_t count) : parent_(count), sizes_(count, 1), flipped_(count, 0) {
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
  std::uint32_t sizeOf(std::uint32_t i) { return sizes_[root(i)]; }
  std::uint32_t parent(std::uint32_t i) const { return parent_[i]; }
  /// Against the parent; of a root false.
  bool flipped(std::uint32_t i) const { return flipped_[i] != 0; }
  /// Joins the groups of `a` and `b` so that their signs differ if `differ` is set; does nothing if they are already
  /// joined.
  void join(std::uint32_t a, std::uint32_t b, bool differ) {
    const std::uint32_t rootA = root(a), rootB = root(b);
    if (rootA == rootB) return;
    parent_[rootB] = rootA;
    sizes_[rootA] += sizes_[rootB];
    flipped_[rootB] = static_cast<std::uint8_t>((flipped_[a] ^ flipped_[b] ^ (differ ? 1 : 0)) & 1);
  }

 private:
  std::vector<std::uint32_t> parent_, sizes_;
  std::vector<std::uint8_t> flipped_;  // against the parent; 0 for roots
};

constexpr std::size_t kClasses = 256;

/// An edge of the spanning tree. The cost is rounded to a byte, which makes the sort one counting pass and changes the
/// tree only among edges of about equal cost.
struct Edge {
  std::size_t costClass;  ///< kClasses more for a long one
  bool differ;            ///< whether the current normals disagree
};

// An edge that is longer than this, in reaches of one of its ends, leads from a point that floats about to a surface,
// or from a sparse part of a surface to a dense one. So does a shorter one of which only one end knows the other, also
// if the reaches of its ends differ by a factor.
constexpr float kLong = 3, kLongOneWay = 1.8f, kUneven = 1.5f;
// Number of points from which on long edges alone join a part to another only if enough of them agree: a part of n
// points has a border of about sqrt(n), whereas the signs of points that float about are random. Of these edges count
// those up to a cost; most edges from a point that floats about are normal to the surface.
constexpr std::uint32_t kPart = 500;
constexpr double kAgree = 0.8, kBorder = 1;
constexpr float kSmooth = 0.6f;

constexpr std::size_t classOf(float cost) { return static_cast<std::size_t>(std::min(cost, 1.0f) * (kClasses - 1)); }

/// `isMutual()`: whether both ends know each other.
template <class IsMutual>
Edge edgeBetween(std::span<const Vec3> points, std::span<const Vec3> normals, std::span<const float> reaches,
                 std::size_t i, std::size_t j, IsMutual&& isMutual) {
  const Vec3 way = points[j] - points[i];
  const Vec3 along = glm::normalize(way);
  const float offI = glm::dot(normals[i], along), offJ = glm::dot(normals[j], along);
  const float agreement = glm::dot(normals[i], normals[j]) - 2 * offI * offJ;
  const float turn = std::sqrt(1 - std::min(1.0f, std::abs(agreement)));
  const float cost = std::max({turn, std::abs(offI), std::abs(offJ)});
  const float length = glm::length(way), reach = std::min(reaches[i], reaches[j]);
  const bool isSuspect = length > kLongOneWay * reach || std::max(reaches[i], reaches[j]) > kUneven * reach;
  const bool isLong = length > kLong * reach || (isSuspect && !isMutual());
  return {classOf(cost) + (isLong ? kClasses : 0), agreement < 0};
}

/// The mean distance of each point to its neighbours; 0 for one without any.
std::vector<float> reachesOf(std::span<const Vec3> points, const NeighbourGraph& graph, unsigned threads) {
  std::vector<float> reaches(points.size());
  parallelFor(points.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      float sum = 0, count = 0;
      for (const std::uint32_t j : graph.of(i)) {
        if (j == NeighbourGraph::kNobody || j == i) continue;
        sum += glm::length(points[j] - points[i]);
        ++count;
      }
      reaches[i] = count > 0 ? sum / count : 0;
    }
  });
  return reaches;
}

using EdgeEnds = std::array<std::uint32_t, 2>;
constexpr std::uint32_t kDiffer = 1u << 31;  // in the second end; clouds hold fewer points than that

/// Of the edges that begin at some consecutive points, by their index there: the class, and whether the normals
/// disagree; kNoEdge where there is none.
using FoundEdges = std::span<std::uint16_t>;
constexpr std::uint16_t kNoEdge = 0xffff, kDiffers = 0x8000;

/// Leaves out the short edges among the points from `first` on that close a cycle of edges before them in the order of
/// the list: no spanning tree has them. `counts`: of the edges by class.
void leaveOutCycles(std::size_t first, const NeighbourGraph& graph, FoundEdges found,
                    std::span<std::size_t, 2 * kClasses> counts) {
  const std::size_t points = found.size() / graph.degree;
  const auto otherEnd = [&](std::size_t at) { return graph.neighbours[first * graph.degree + at] - first; };
  const auto isInside = [&](std::size_t at) {
    return found[at] != kNoEdge && (found[at] & ~kDiffers) < kClasses && otherEnd(at) < points;
  };
  std::array<std::size_t, kClasses + 1> next{};
  for (std::size_t at = 0; at < found.size(); ++at)
    if (isInside(at)) ++next[(found[at] & ~kDiffers) + 1];
  std::partial_sum(next.begin(), next.end(), next.begin());
  BareVector<std::uint32_t> ordered(next.back());
  for (std::size_t at = 0; at < found.size(); ++at)
    if (isInside(at)) ordered[next[found[at] & ~kDiffers]++] = static_cast<std::uint32_t>(at);
  std::vector<std::uint32_t> parent(points);
  std::iota(parent.begin(), parent.end(), 0u);
  const auto root = [&](std::size_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return static_cast<std::uint32_t>(i);
  };
  for (const std::uint32_t at : ordered) {
    const std::uint32_t a = root(at / graph.degree), b = root(otherEnd(at));
    if (a != b) {
      parent[b] = a;
      continue;
    }
    --counts[found[at] & ~kDiffers];
    found[at] = kNoEdge;
  }
}

/// The edges of the graph, each once, but for those that no spanning tree has: the long ones last, by cost and then by
/// their points.
struct SortedEdges {
  BareVector<EdgeEnds> all;
  std::size_t firstLong = 0, firstSteep = 0;  ///< of the long ones that cost more than kSmooth
};

SortedEdges edgesByCost(std::span<const Vec3> points, std::span<const Vec3> normals, const NeighbourGraph& graph,
                        std::span<const float> reaches, unsigned threads) {
  constexpr std::size_t kSmallest = 1 << 12, kLargest = 1 << 18;  // points
  WorkerTeam team(threads);
  const std::size_t chunkSize = std::clamp(points.size() / (4 * team.size()), kSmallest, kLargest);
  const std::size_t chunks = (points.size() + chunkSize - 1) / chunkSize;
  std::vector<std::array<std::size_t, 2 * kClasses>> next(chunks);  // counts, then the index of a chunk's next edge
  BareVector<std::uint16_t> found(graph.neighbours.size());         // class, and whether the normals disagree
  const auto forEachNeighbour = [&](std::size_t chunk, auto&& body) {
    for (std::size_t i = chunk * chunkSize; i < std::min(points.size(), (chunk + 1) * chunkSize); ++i)
      for (std::size_t k = 0; k < graph.degree; ++k) body(i, graph.of(i)[k], found[i * graph.degree + k]);
  };
  team.forEach(chunks, [&](std::size_t chunk) {
    next[chunk].fill(0);
    forEachNeighbour(chunk, [&](std::size_t i, std::uint32_t j, std::uint16_t& own) {
      own = kNoEdge;
      if (j == NeighbourGraph::kNobody || j == i) return;
      const auto isKnown = [&] { return graph.hasEdge(j, static_cast<std::uint32_t>(i)); };
      if (j < i && isKnown()) return;  // seen from the other end
      const Edge edge = edgeBetween(points, normals, reaches, i, j, [&] { return j > i && isKnown(); });
      ++next[chunk][edge.costClass];
      own = static_cast<std::uint16_t>(edge.costClass | (edge.differ ? kDiffers : 0));
    });
    const std::size_t first = chunk * chunkSize, last = std::min(points.size(), first + chunkSize);
    leaveOutCycles(first, graph, FoundEdges(found).subspan(first * graph.degree, (last - first) * graph.degree),
                   next[chunk]);
  });
  std::size_t total = 0;
  for (std::size_t costClass = 0; costClass < 2 * kClasses; ++costClass)
    for (auto& chunk : next) total += std::exchange(chunk[costClass], total);
  SortedEdges sorted;
  sorted.all.resize(total);
  if (chunks > 0) sorted.firstLong = next[0][kClasses], sorted.firstSteep = next[0][kClasses + classOf(kSmooth)];
  team.forEach(chunks, [&](std::size_t chunk) {
    forEachNeighbour(chunk, [&](std::size_t i, std::uint32_t j, std::uint16_t own) {
      if (own == kNoEdge) return;
      const std::uint32_t differ = (own & kDiffers) != 0 ? kDiffer : 0;
      sorted.all[next[chunk][own & (kDiffers - 1)]++] = {static_cast<std::uint32_t>(i), j | differ};
    });
  });
  return sorted;
}

struct Ends {
  std::uint32_t a, b;
  bool differ;
};

Ends unpacked(const EdgeEnds& edge) { return {edge[0], edge[1] & ~kDiffer, (edge[1] & kDiffer) != 0}; }

/// Joins the parts between which enough of the long edges agree.
void joinParts(const SortedEdges& edges, SignGroups& groups) {
  std::map<EdgeEnds, std::array<std::uint32_t, 2>> votes;  // of two parts: edges along which their signs agree, differ
  for (std::size_t k = edges.firstLong; k < edges.firstSteep; ++k) {
    const Ends ends = unpacked(edges.all[k]);
    const std::uint32_t a = groups.root(ends.a), b = groups.root(ends.b);
    if (a == b || groups.sizeOf(a) < kPart || groups.sizeOf(b) < kPart) continue;
    const bool differ = ends.differ != (groups.isFlipped(ends.a) != groups.isFlipped(ends.b));
    ++votes[{std::min(a, b), std::max(a, b)}][differ ? 1 : 0];
  }
  for (const auto& [parts, count] : votes) {
    const double all = count[0] + count[1], most = std::max(count[0], count[1]);
    const double border = kBorder * std::sqrt(std::min(groups.sizeOf(parts[0]), groups.sizeOf(parts[1])));
    if (all >= border && most >= kAgree * all) groups.join(parts[0], parts[1], count[1] > count[0]);
  }
}

bool topFacesDown(std::span<const FacingPoint> surface) {
  const auto top = std::ranges::max_element(surface, {}, [](const FacingPoint& point) { return point.position.z; });
  return top->normal.z < 0;
}

/// For each point whether its normal is flipped, so that each group faces outwards.
std::vector<std::uint8_t> turnsOf(std::span<const Vec3> points, std::span<const Vec3> normals,
                                  std::span<const float> reaches, SignGroups& groups, std::optional<UpAxis> up,
                                  unsigned threads) {
  const auto count = static_cast<std::uint32_t>(points.size());
  std::vector<std::uint32_t> next(count + 1);  // counts, then first members, then the end of each group's members
  StopChecks checks;
  for (std::uint32_t i = 0; i < count; ++i) {
    checks();
    ++next[groups.root(i) + 1];
  }
  // Now each point is its root, or a direct child of it.
  const SignGroups& direct = groups;
  std::partial_sum(next.begin(), next.end(), next.begin());
  BareVector<std::uint32_t> members(count);
  for (std::uint32_t i = 0; i < count; ++i) members[next[direct.parent(i)]++] = i;
  std::vector<std::uint8_t> turns(count);
  for (std::uint32_t begin = 0, end = 0; begin < count; begin = end) {
    checks();
    end = next[direct.parent(members[begin])];
    const auto group = std::span(members).subspan(begin, end - begin);
    auto surface = parallelMake(group.size(), threads, [&](std::size_t n) {
      const std::uint32_t i = group[n];
      return FacingPoint{points[i], direct.flipped(i) ? -normals[i] : normals[i], reaches[i]};
    });
    const bool inwards = up ? facesInwards(std::move(surface), *up, threads) : topFacesDown(surface);
    parallelFor(group.size(), threads, [&](std::size_t first, std::size_t last) {
      for (const std::uint32_t i : group.subspan(first, last - first)) turns[i] = inwards != direct.flipped(i);
    });
  }
  return turns;
}

}  // namespace

void orientNormals(std::span<const Vec3> points, std::span<Vec3> normals, const NeighbourGraph& graph, unsigned threads,
                   std::optional<UpAxis> up) {
  constexpr float kFar = std::numeric_limits<float>::infinity();  // no edge is long
  const std::vector<float> reaches = up ? reachesOf(points, graph, threads) : std::vector<float>(points.size(), kFar);
  SignGroups groups(points.size());
  StopChecks checks;
  const SortedEdges edges = edgesByCost(points, normals, graph, reaches, threads);
  for (std::size_t k = 0; k < edges.all.size(); ++k) {  // Kruskal's algorithm
    checks();
    if (k == edges.firstLong) joinParts(edges, groups);
    const auto [a, b, differ] = unpacked(edges.all[k]);
    if (k < edges.firstLong || groups.sizeOf(a) < kPart || groups.sizeOf(b) < kPart) groups.join(a, b, differ);
  }
  const std::vector<std::uint8_t> turns = turnsOf(points, normals, reaches, groups, up, threads);
  parallelFor(normals.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (turns[i]) normals[i] = -normals[i];
  });
}

}  // namespace palpate
