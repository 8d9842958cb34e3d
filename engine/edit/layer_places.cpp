#include "engine/edit/layer_places.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "engine/cloud/shortest_rotation.hpp"
#include "engine/core/parallel.hpp"
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
  std::vector<LayerPlace> places();

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

  void addRecord(const LayerRecord& record);
  void addInserted(const PointStates& present);
  void addRing(const PointStates& present);
  void link();
  void findTorn();
  void relax();
  void project(const FacingTree& surface);
  void placeInserted();
  void placeRemoved();
  std::size_t indexOf(std::uint64_t point) const;

  std::vector<Node> nodes_;  // ascending by number; then those of the ring
  struct Removed {
    LayerPlace place;
    bool isMoved = false;
  };
  std::vector<Removed> removed_;  // by the strokes
  std::size_t known_ = 0;         // nodes before this one are ascending by number
};

ShapeMaker::ShapeMaker(std::span<const LayerRecord> records, const PointStates& present) {
  for (const LayerRecord& record : records) addRecord(record);
  known_ = nodes_.size();
  addInserted(present);
  addRing(present);
  link();
  findTorn();
  relax();
  placeInserted();
  placeRemoved();
}

void ShapeMaker::addRecord(const LayerRecord& record) {
  const PointState &before = record.before, &after = record.after, &present = record.present;
  if (before.gone && after.gone) return;
  LayerPlace place{.number = after.number,
                   .one = present.position,
                   .oneNormal = present.normal,
                   .base = before.position,
                   .zero = before.position,
                   .zeroNormal = before.normal,
                   .kind = before.gone  ? Kind::inserted
                           : after.gone ? Kind::cut
                                        : Kind::kept,
                   .isSeen = static_cast<std::uint8_t>(!present.gone)};
  if (after.gone) {
    const DVec3 moved = DVec3(present.position) - DVec3(after.position);  // by other layers since
    place.base = Vec3(DVec3(before.position) + moved);
    place.zero = present.position;
    removed_.push_back({place, moved != DVec3(0)});
    return;
  }
  Node node{.place = place, .found = before.position, .before = DVec3(before.position)};
  if (!record.isUntouched) {
    const DVec3 moved = DVec3(present.position) - (node.before + record.displacement);
    const DVec3 from = unitVector(DVec3(after.normal), {0, 0, 1}), to = unitVector(DVec3(before.normal), {0, 0, 1});
    const DQuat turn = shortestRotation(from, to);
    node.others = record.isOfMany ? moved : turn * moved;
    node.place.zeroNormal = Vec3(turn * DVec3(present.normal));
    node.place.base = node.place.zero = Vec3(node.before + node.others);
  }
  nodes_.push_back(node);
}

std::size_t ShapeMaker::indexOf(std::uint64_t point) const {
  const auto end = nodes_.begin() + static_cast<std::ptrdiff_t>(known_);
  const auto at =
      std::ranges::lower_bound(nodes_.begin(), end, point, {}, [](const Node& node) { return node.place.number; });
  return at != end && at->place.number == point ? static_cast<std::size_t>(at - nodes_.begin()) : nodes_.size();
}

// Numbers of descendants are higher than those of their parents, and so these are in order.
void ShapeMaker::addInserted(const PointStates& present) {
  if (nodes_.empty()) return;
  std::vector<Node> inserted;
  std::vector<std::uint64_t> numbers;
  for (const PointState& state : present) {
    if (state.gone || state.parent == state.number) continue;
    if (indexOf(state.parent) == nodes_.size() && !std::ranges::binary_search(numbers, state.parent)) continue;
    if (indexOf(state.number) < nodes_.size()) continue;
    numbers.push_back(state.number);
    inserted.push_back(
        {.place = {.number = state.number, .one = state.position, .oneNormal = state.normal}, .isKnown = false});
  }
  std::ranges::move(inserted, std::back_inserter(nodes_));
  std::ranges::sort(nodes_, {}, [](const Node& node) { return node.place.number; });
  known_ = nodes_.size();
}

void ShapeMaker::addRing(const PointStates& present) {
  std::vector<Vec3> positions;
  Vec3 low(std::numeric_limits<float>::max()), high = -low;
  for (const Node& node : nodes_)
    if (node.place.isSeen) positions.push_back(node.place.one);
  for (const Removed& removed : removed_) positions.push_back(removed.place.base);
  if (positions.empty()) return;
  const PointTree tree(positions);
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
  std::vector<std::uint8_t> isNear(present.size());
  const PointState* const states = present.begin();
  parallelFor(present.size(), 0, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3& at = states[i].position;
      if (states[i].gone || glm::any(glm::lessThan(at, low)) || glm::any(glm::greaterThan(at, high))) continue;
      if (indexOf(states[i].number) < nodes_.size()) continue;
      std::array<std::uint32_t, 1> found;
      std::array<double, 1> squared;
      isNear[i] = tree.nearest(at, found, squared) > 0 && squared[0] < reach * reach;
    }
  });
  std::vector<Node> ring;
  for (std::size_t i = 0; i < isNear.size(); ++i)
    if (isNear[i]) {
      const PointState& at = states[i];
      ring.push_back({.place = {.number = at.number,
                                .one = at.position,
                                .oneNormal = at.normal,
                                .base = at.position,
                                .zero = at.position,
                                .zeroNormal = at.normal},
                      .before = DVec3(at.position),
                      .isFixed = true});
    }
  std::ranges::move(ring, std::back_inserter(nodes_));
}

void ShapeMaker::link() {
  std::vector<Vec3> positions, normals;
  std::vector<std::uint32_t> indices;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    if (!nodes_[i].place.isSeen) continue;
    positions.push_back(nodes_[i].place.one);
    normals.push_back(nodes_[i].place.oneNormal);
    indices.push_back(static_cast<std::uint32_t>(i));
  }
  if (indices.empty()) return;
  const FacingTree tree(std::move(positions), std::move(normals));
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
  std::vector<std::uint32_t> front;
  for (std::uint32_t i = 0; i < nodes_.size(); ++i) {
    const Node& node = nodes_[i];
    if (!node.isFound() || node.isFixed) continue;
    for (const std::uint32_t k : node.near()) {
      const Node& other = nodes_[k];
      const double spacing = std::max({node.spacing, other.spacing, 1e-30});
      const double apart = glm::distance(node.before, other.before) / spacing;
      if (other.isFound() && apart > kTorn) rings[i] = std::max(rings[i], apart);
    }
    if (rings[i] > 0) front.push_back(i);
  }
  for (std::size_t next = 0; next < front.size(); ++next) {
    const double left = rings[front[next]] - 1;
    if (left <= 0) continue;
    for (const std::uint32_t k : nodes_[front[next]].near())
      if (rings[k] < left && !nodes_[k].isFixed) rings[k] = left, front.push_back(k);
  }
  for (std::size_t i = 0; i < nodes_.size(); ++i) nodes_[i].isTorn = rings[i] > 0 && nodes_[i].isKnown;
}

void ShapeMaker::project(const FacingTree& surface) {
  parallelFor(nodes_.size(), 0, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Node& node = nodes_[i];
      if (!node.isSpread()) continue;
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
  std::vector<Vec3> positions, normals;
  bool isAny = false;
  for (const Node& node : nodes_) {
    isAny = isAny || node.isSpread();
    if (!node.isKnown || node.place.kind == Kind::inserted) continue;
    positions.push_back(Vec3(node.before));
    normals.push_back(node.place.zeroNormal);
  }
  for (const auto& [place, isMoved] : removed_) positions.push_back(place.base), normals.push_back(place.zeroNormal);
  if (!isAny || positions.empty()) return;
  const FacingTree surface(std::move(positions), std::move(normals));
  std::vector<DVec3> next(nodes_.size()), others(nodes_.size());
  for (int sweep = 1; sweep <= kSweeps; ++sweep) {
    parallelFor(nodes_.size(), 0, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const Node& node = nodes_[i];
        if (!node.isSpread()) continue;
        DVec3 sum{0}, moved{0};
        double count = 0;
        for (const std::uint32_t k : node.near())
          if (nodes_[k].isKnown) sum += nodes_[k].before, moved += nodes_[k].others, ++count;
        next[i] = count > 0 ? sum / count : node.before;
        others[i] = count > 0 && sweep <= 4 ? moved / count : node.others;
      }
    });
    for (std::size_t i = 0; i < nodes_.size(); ++i)
      if (nodes_[i].isSpread()) nodes_[i].before = next[i], nodes_[i].others = others[i];
    if (sweep % kBetweenProjections == 0) project(surface);
  }
  for (Node& node : nodes_) {
    node.place.isTorn = static_cast<std::uint8_t>(node.isTorn);
    if (node.isSpread()) node.place.base = Vec3(node.before + node.others);
  }
}

// They go along with those around them.
void ShapeMaker::placeInserted() {
  std::vector<Node*> inserted;
  for (Node& node : nodes_)
    if (!node.isKnown) inserted.push_back(&node), node.before = DVec3(node.place.one);
  for (int sweep = 0; sweep < 12; ++sweep)
    for (Node* const each : inserted) {
      Node& node = *each;
      DVec3 sum{0}, normal{0};
      for (const std::uint32_t k : node.near()) {
        const Node& other = nodes_[k];
        sum += (other.isKnown ? DVec3(other.place.base) : other.before) - DVec3(other.place.one);
        if (other.isKnown) normal += DVec3(other.place.zeroNormal);
      }
      if (node.nearCount > 0) node.before = DVec3(node.place.one) + sum / static_cast<double>(node.nearCount);
      node.place.zeroNormal = Vec3(unitVector(normal, DVec3(node.place.oneNormal)));
    }
  for (Node* const node : inserted) node->place.base = node->place.zero = Vec3(node->before);
}

// Those that are at 0 alone go along with the points that are nearest to them there; at 0 torn points are where they
// were, and what others have done since is as around them.
void ShapeMaker::placeRemoved() {
  std::vector<Vec3> positions, normals;
  std::vector<std::uint32_t> indices;
  for (std::uint32_t i = 0; i < nodes_.size(); ++i) {
    if (!nodes_[i].place.isSeen) continue;
    positions.push_back(nodes_[i].isKnown ? Vec3(nodes_[i].before) : nodes_[i].place.base);
    normals.push_back(nodes_[i].place.zeroNormal);
    indices.push_back(i);
  }
  if (indices.empty() || (removed_.empty() && std::ranges::none_of(nodes_, &Node::isTorn))) return;
  const FacingTree tree(std::move(positions), std::move(normals));
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
  parallelFor(nodes_.size(), 0, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Node& node = nodes_[i];
      if (!node.isTorn || node.place.kind != Kind::kept) continue;
      node.place.zero = Vec3(DVec3(node.found) + around(node.found, node.place.zeroNormal).others);
    }
  });
  std::vector<Vec3> after;
  std::vector<Vec3> facing;
  for (const std::uint32_t i : indices)
    after.push_back(nodes_[i].place.one), facing.push_back(nodes_[i].place.oneNormal);
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

std::vector<LayerPlace> ShapeMaker::places() {
  std::vector<LayerPlace> places;
  for (const Removed& removed : removed_) places.push_back(removed.place);
  for (Node& node : nodes_) places.push_back(node.place);
  std::ranges::sort(places, {}, &LayerPlace::number);
  return places;
}

}  // namespace

std::vector<LayerPlace> layerPlaces(std::span<const LayerRecord> records, const PointStates& present) {
  return ShapeMaker(records, present).places();
}

}  // namespace palpate
