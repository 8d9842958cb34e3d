#include "engine/edit/layer_places.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "engine/cloud/shortest_rotation.hpp"
#include "engine/core/parallel_collect.hpp"
#include "engine/core/parallel_radix_sort.hpp"
#include "engine/edit/facing_tree.hpp"

namespace palpate {

namespace {

using Kind = LayerPlace::Kind;

constexpr std::size_t kSpacingOf = 6;  // neighbours whose mean distance is the spacing
constexpr double kRing = 4;            // width of the surroundings, spacings
constexpr double kTorn = 2.5;          // neighbours that were farther apart than that before, spacings, are torn
constexpr int kSweeps = 80, kBetweenProjections = 8;
constexpr double kMerged = 0.75, kUncovered = 2.5;  // from the next point, spacings

DVec3 unitVector(const DVec3& v, const DVec3& otherwise) {
  const double length = glm::length(v);
  return length > 1e-6 ? v / length : otherwise;
}

/// The points at strength 1 while their places before are found.
class ShapeMaker {
 public:
  ShapeMaker(std::span<const LayerRecord> records, const PointStates& present);
  BareVector<LayerPlace> places() const;

 private:
  struct Node {
    LayerPlace place;
    Vec3 found{0};         // where the strokes found it
    DVec3 before{0};       // on the surface before the strokes
    DVec3 others{0};       // what others have moved it by since, as seen from that surface
    bool isKnown = true;   // false: others have inserted it
    bool isFixed = false;  // its surroundings, which stay
    bool isTorn = false;
    double spacing = 0;  // at strength 1
    std::array<std::uint32_t, kSpacingOf> nearest{};
    std::size_t nearCount = 0;

    std::span<const std::uint32_t> near() const { return std::span(nearest).first(nearCount); }
    /// The strokes found it: others share the surface before with those around them.
    bool isFound() const { return isKnown && place.kind == Kind::kept; }
    bool isSpread() const { return isTorn || (isKnown && place.kind == Kind::inserted); }
  };
  struct Removed {
    LayerPlace place;
    bool isMoved = false;
  };

  static Node nodeOf(const LayerRecord& record);
  static Removed removedOf(const LayerRecord& record);
  void addInserted(const PointStates& present);
  void addRing(const PointStates& present);
  void link();
  void findTorn();
  void relax();
  void project(const FacingTree& surface, std::span<const std::uint32_t> spread);
  void placeInserted();
  void placeRemoved();
  bool has(std::uint64_t point) const {
    return std::ranges::binary_search(nodes_, point, {}, [](const Node& node) { return node.place.number; });
  }
  /// Indices of the nodes with is(node).
  template <class Is>
  BareVector<std::uint32_t> indicesOf(const Is& is) const {
    return parallelCollect(
        nodes_.size(), 0, [&](std::size_t i) { return std::invoke(is, nodes_[i]); },
        [](std::size_t i) { return static_cast<std::uint32_t>(i); });
  }
  /// get(node) of each of these nodes.
  template <class Get>
  BareVector<Vec3> of(std::span<const std::uint32_t> indices, const Get& get) const {
    return parallelMake(indices.size(), 0, [&](std::size_t k) { return Vec3(std::invoke(get, nodes_[indices[k]])); });
  }
  static bool isSeen(const Node& node) { return node.place.isSeen != 0; }
  static Vec3 one(const Node& node) { return node.place.one; }
  static Vec3 oneNormal(const Node& node) { return node.place.oneNormal; }
  static Vec3 zeroNormal(const Node& node) { return node.place.zeroNormal; }

  BareVector<Node> nodes_;       // ascending by number; then those of the ring
  BareVector<Removed> removed_;  // by the strokes
};

ShapeMaker::ShapeMaker(std::span<const LayerRecord> records, const PointStates& present) {
  const auto recordsWith = [&](auto&& is) {
    return parallelCollect(
        records.size(), 0, [&](std::size_t i) { return is(records[i]); }, [](std::size_t i) { return i; });
  };
  const auto kept = recordsWith([](const LayerRecord& record) { return !record.after.gone; });
  const auto cut = recordsWith([](const LayerRecord& record) { return record.after.gone && !record.before.gone; });
  nodes_.reserve(kept.size() / 4 * 5);  // with the ring, most often
  nodes_.resize(kept.size());
  parallelFor(kept.size(), 0, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) nodes_[i] = nodeOf(records[kept[i]]);
  });
  removed_ = parallelMake(cut.size(), 0, [&](std::size_t i) { return removedOf(records[cut[i]]); });
  addInserted(present);
  addRing(present);
  link();
  findTorn();
  relax();
  placeInserted();
  placeRemoved();
}

LayerPlace placeOf(const LayerRecord& record) {
  return {.number = record.after.number,
          .one = record.present.position,
          .oneNormal = record.present.normal,
          .base = record.before.position,
          .zero = record.before.position,
          .zeroNormal = record.before.normal,
          .kind = record.before.gone  ? Kind::inserted
                  : record.after.gone ? Kind::cut
                                      : Kind::kept,
          .isSeen = static_cast<std::uint8_t>(!record.present.gone)};
}

ShapeMaker::Removed ShapeMaker::removedOf(const LayerRecord& record) {
  const DVec3 moved = DVec3(record.present.position) - DVec3(record.after.position);  // by other layers since
  Removed removed{placeOf(record), moved != DVec3(0)};
  removed.place.base = Vec3(DVec3(record.before.position) + moved);
  removed.place.zero = record.present.position;
  return removed;
}

ShapeMaker::Node ShapeMaker::nodeOf(const LayerRecord& record) {
  const PointState &before = record.before, &after = record.after, &present = record.present;
  Node node{.place = placeOf(record), .found = before.position, .before = DVec3(before.position)};
  if (!record.isUntouched) {
    const DVec3 moved = DVec3(present.position) - (node.before + record.displacement);
    const DVec3 from = unitVector(DVec3(after.normal), {0, 0, 1}), to = unitVector(DVec3(before.normal), {0, 0, 1});
    const DQuat turn = shortestRotation(from, to);
    node.others = record.isOfMany ? moved : turn * moved;
    node.place.zeroNormal = Vec3(turn * DVec3(present.normal));
    node.place.base = node.place.zero = Vec3(node.before + node.others);
  }
  return node;
}

// Numbers of descendants are higher than those of their parents, and so these are in order.
void ShapeMaker::addInserted(const PointStates& present) {
  if (nodes_.empty()) return;
  BareVector<Node> inserted;
  std::vector<std::uint64_t> numbers;
  for (const PointState& state : present.added()) {
    if (state.gone || state.parent == state.number) continue;
    if (!has(state.parent) && !std::ranges::binary_search(numbers, state.parent)) continue;
    if (has(state.number)) continue;
    numbers.push_back(state.number);
    inserted.push_back(
        {.place = {.number = state.number, .one = state.position, .oneNormal = state.normal}, .isKnown = false});
  }
  const auto middle = static_cast<std::ptrdiff_t>(nodes_.size());
  nodes_.insert(nodes_.end(), inserted.begin(), inserted.end());
  std::ranges::inplace_merge(nodes_, nodes_.begin() + middle, {}, [](const Node& node) { return node.place.number; });
}

void ShapeMaker::addRing(const PointStates& present) {
  Vec3 low(std::numeric_limits<float>::max()), high = -low;
  BareVector<Vec3> positions = of(indicesOf(isSeen), one);
  for (const Removed& removed : removed_) positions.push_back(removed.place.base);
  if (positions.empty()) return;
  const PointTree tree(positions, 0);
  std::vector<double> spacings(std::min<std::size_t>(positions.size(), 256));
  for (std::size_t i = 0; i < spacings.size(); ++i) {
    std::array<std::uint32_t, kSpacingOf + 1> found;
    std::array<double, kSpacingOf + 1> squared;
    const std::size_t count = tree.nearest(positions[i * positions.size() / spacings.size()], found, squared);
    spacings[i] = std::sqrt(squared[count - 1]);
  }
  std::ranges::nth_element(spacings, spacings.begin() + static_cast<std::ptrdiff_t>(spacings.size() / 2));
  const double reach = kRing * spacings[spacings.size() / 2];
  for (const Vec3& position : positions) low = glm::min(low, position), high = glm::max(high, position);
  low -= Vec3(static_cast<float>(reach)), high += Vec3(static_cast<float>(reach));
  enum class Is : std::uint8_t { other, node, ring };
  std::vector<Is> is(present.size());
  parallelFor(nodes_.size(), 0, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (const std::size_t at = present.indexOf(nodes_[i].place.number); at < is.size()) is[at] = Is::node;
  });
  const PointState* const states = present.begin();
  parallelFor(present.size(), 0, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3& at = states[i].position;
      if (states[i].gone || glm::any(glm::lessThan(at, low)) || glm::any(glm::greaterThan(at, high))) continue;
      if (is[i] == Is::node) continue;
      std::array<std::uint32_t, 1> found;
      std::array<double, 1> squared;
      if (tree.nearest(at, found, squared) > 0 && squared[0] < reach * reach) is[i] = Is::ring;
    }
  });
  const BareVector<Node> ring = parallelCollect(
      is.size(), 0, [&](std::size_t i) { return is[i] == Is::ring; },
      [&](std::size_t i) {
        const PointState& at = states[i];
        return Node{.place = {.number = at.number,
                              .one = at.position,
                              .oneNormal = at.normal,
                              .base = at.position,
                              .zero = at.position,
                              .zeroNormal = at.normal},
                    .before = DVec3(at.position),
                    .isFixed = true};
      });
  nodes_.insert(nodes_.end(), ring.begin(), ring.end());
}

void ShapeMaker::link() {
  const BareVector<std::uint32_t> indices = indicesOf(isSeen);
  if (indices.empty()) return;
  const FacingTree tree(of(indices, one), of(indices, oneNormal));
  const std::span<const std::uint32_t> order = tree.order();
  parallelFor(order.size(), 0, [&](std::size_t begin, std::size_t end) {
    for (std::size_t at = begin; at < end; ++at) {
      const std::uint32_t i = indices[order[at]];
      Node& node = nodes_[i];
      double sum = 0;
      tree.visit(node.place.one, node.place.oneNormal, [&](std::uint32_t other, double squared) {
        if (indices[other] == i) return true;
        node.nearest[node.nearCount++] = indices[other];
        sum += std::sqrt(squared);
        return node.nearCount < kSpacingOf;
      });
      if (node.nearCount > 0) node.spacing = sum / static_cast<double>(node.nearCount);
    }
  });
}

// A point is torn where one beside it came from afar, and so are those around it, in as many rings as it was spacings
// away. Inserted points come from nowhere: their parents are beside them, and tear nothing.
void ShapeMaker::findTorn() {
  std::vector<double> rings(nodes_.size());
  parallelFor(nodes_.size(), 0, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Node& node = nodes_[i];
      if (!node.isFound() || node.isFixed) continue;
      for (const std::uint32_t k : node.near()) {
        const Node& other = nodes_[k];
        const double spacing = std::max({node.spacing, other.spacing, 1e-30});
        const double apart = glm::distance(node.before, other.before) / spacing;
        if (other.isFound() && apart > kTorn) rings[i] = std::max(rings[i], apart);
      }
    }
  });
  BareVector<std::uint32_t> front = parallelCollect(
      rings.size(), 0, [&](std::size_t i) { return rings[i] > 0; },
      [](std::size_t i) { return static_cast<std::uint32_t>(i); });
  if (front.empty()) return;
  for (std::size_t next = 0; next < front.size(); ++next) {
    const double left = rings[front[next]] - 1;
    if (left <= 0) continue;
    for (const std::uint32_t k : nodes_[front[next]].near())
      if (rings[k] < left && !nodes_[k].isFixed) rings[k] = left, front.push_back(k);
  }
  for (std::size_t i = 0; i < nodes_.size(); ++i) nodes_[i].isTorn = rings[i] > 0 && nodes_[i].isKnown;
}

void ShapeMaker::project(const FacingTree& surface, std::span<const std::uint32_t> spread) {
  parallelFor(spread.size(), 0, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Node& node = nodes_[spread[i]];
      DVec3 middle{0}, normal{0};
      int count = 0;
      surface.visit(Vec3(node.before), node.place.zeroNormal, [&](std::uint32_t k, double) {
        middle += DVec3(surface.position(k)), normal += DVec3(surface.normal(k));
        return ++count < 6;
      });
      if (count == 0 || glm::length(normal) < 1e-6) continue;
      normal = glm::normalize(normal);
      node.before -= glm::dot(node.before - middle / static_cast<double>(count), normal) * normal;
    }
  });
}

void ShapeMaker::relax() {
  const BareVector<std::uint32_t> spread = indicesOf(&Node::isSpread);
  if (spread.empty()) return;
  const auto found = indicesOf([](const Node& node) { return node.isKnown && node.place.kind != Kind::inserted; });
  BareVector<Vec3> positions = of(found, &Node::before), normals = of(found, zeroNormal);
  for (const auto& [place, isMoved] : removed_) positions.push_back(place.base), normals.push_back(place.zeroNormal);
  if (positions.empty()) return;
  const FacingTree surface(std::move(positions), std::move(normals));
  std::vector<DVec3> next(spread.size()), others(spread.size());
  for (int sweep = 1; sweep <= kSweeps; ++sweep) {
    parallelFor(spread.size(), 0, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const Node& node = nodes_[spread[i]];
        DVec3 sum{0}, moved{0};
        double count = 0;
        for (const std::uint32_t k : node.near())
          if (nodes_[k].isKnown) sum += nodes_[k].before, moved += nodes_[k].others, ++count;
        next[i] = count > 0 ? sum / count : node.before;
        others[i] = count > 0 && sweep <= 4 ? moved / count : node.others;
      }
    });
    parallelFor(spread.size(), 0, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        nodes_[spread[i]].before = next[i], nodes_[spread[i]].others = others[i];
    });
    if (sweep % kBetweenProjections == 0) project(surface, spread);
  }
  for (const std::uint32_t i : spread) nodes_[i].place.base = Vec3(nodes_[i].before + nodes_[i].others);
}

// They go along with those around them.
void ShapeMaker::placeInserted() {
  const BareVector<std::uint32_t> inserted = indicesOf([](const Node& node) { return !node.isKnown; });
  for (const std::uint32_t i : inserted) nodes_[i].before = DVec3(nodes_[i].place.one);
  for (int sweep = 0; sweep < 12; ++sweep)
    for (const std::uint32_t i : inserted) {
      Node& node = nodes_[i];
      DVec3 sum{0}, normal{0};
      for (const std::uint32_t k : node.near()) {
        const Node& other = nodes_[k];
        sum += (other.isKnown ? DVec3(other.place.base) : other.before) - DVec3(other.place.one);
        if (other.isKnown) normal += DVec3(other.place.zeroNormal);
      }
      if (node.nearCount > 0) node.before = DVec3(node.place.one) + sum / static_cast<double>(node.nearCount);
      node.place.zeroNormal = Vec3(unitVector(normal, DVec3(node.place.oneNormal)));
    }
  for (const std::uint32_t i : inserted) nodes_[i].place.base = nodes_[i].place.zero = Vec3(nodes_[i].before);
}

// Those that are at 0 alone go along with the points that are nearest to them there; at 0 torn points are where they
// were, and what others have done since is as around them.
void ShapeMaker::placeRemoved() {
  const BareVector<std::uint32_t> indices = indicesOf(isSeen), torn = indicesOf([](const Node&node) {
                                                                 return node.isTorn && node.place.kind == Kind::kept;
                                                               });
  if (indices.empty() || (removed_.empty() && torn.empty())) return;
  const auto before = [](const Node& node) { return node.isKnown ? Vec3(node.before) : node.place.base; };
  const FacingTree tree(of(indices, before), of(indices, zeroNormal));
  struct Around {
    DVec3 others{0}, displacement{0};
    double nearest = std::numeric_limits<double>::infinity(), spacing = 0;
  };
  const auto around = [&](const Vec3& at, const Vec3& facing) {
    Around found;
    double count = 0;
    tree.visit(at, facing, [&](std::uint32_t k, double squared) {
      const Node& node = nodes_[indices[k]];
      found.nearest = std::min(found.nearest, std::sqrt(squared));
      found.spacing = std::max(found.spacing, node.spacing);
      if (node.isKnown) found.others += node.others;
      found.displacement += DVec3(node.place.one) - DVec3(node.place.base);
      return ++count < 5;
    });
    if (count > 0) found.others /= count, found.displacement /= count;
    return found;
  };
  parallelFor(torn.size(), 0, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Node& node = nodes_[torn[i]];
      node.place.zero = Vec3(DVec3(node.found) + around(node.found, node.place.zeroNormal).others);
    }
  });
  const BareVector<Vec3> after = of(indices, one);
  const PointTree ones(after);
  parallelFor(removed_.size(), 0, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      auto& [place, isMoved] = removed_[i];
      const Around found = around(place.base, place.zeroNormal);
      if (!isMoved) place.base = Vec3(DVec3(place.base) + found.others);
      place.one = Vec3(DVec3(place.base) + found.displacement);
      std::array<std::uint32_t, 1> next;
      std::array<double, 1> squared;
      const bool isAny = ones.nearest(place.one, next, squared) > 0;
      place.oneNormal = isAny ? nodes_[indices[next[0]]].place.oneNormal : place.zeroNormal;
      const bool isThere = isAny && found.nearest < kUncovered * found.spacing &&
                           std::sqrt(squared[0]) < kMerged * nodes_[indices[next[0]]].spacing;
      place.kind = isThere ? Kind::merged : Kind::cut;
      place.isSeen = 1;
    }
  });
}

BareVector<LayerPlace> ShapeMaker::places() const {
  const auto placeOf = [&](std::size_t i) -> const LayerPlace& {
    return i < nodes_.size() ? nodes_[i].place : removed_[i - nodes_.size()].place;
  };
  auto order = parallelMake(nodes_.size() + removed_.size(), 0, [](std::size_t i) { return i; });
  const auto numberOf = [&](std::size_t i) { return placeOf(i).number; };
  std::uint64_t numbers = 0;
  for (const std::size_t i : order) numbers |= numberOf(i);
  parallelRadixSort(order, static_cast<unsigned>(std::bit_width(numbers)), 0, numberOf);
  return parallelMake(order.size(), 0, [&](std::size_t i) { return placeOf(order[i]); });
}

}  // namespace

BareVector<LayerPlace> layerPlaces(std::span<const LayerRecord> records, const PointStates& present) {
  return ShapeMaker(records, present).places();
}

}  // namespace palpate
