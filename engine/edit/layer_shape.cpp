#include "engine/edit/layer_shape.hpp"

#include <cmath>
#include <limits>

#include "engine/cloud/shortest_rotation.hpp"
#include "engine/core/parallel_collect.hpp"
#include "engine/edit/facing_tree.hpp"

namespace palpate {

namespace {

using Kind = LayerPlace::Kind;

constexpr std::size_t kMeanOf = 6;               // neighbours whose mean distance is the spacing
constexpr double kCrowded = 0.75, kApart = 1.5;  // from the next point, spacings

// It is on the surface before the strokes alone.
bool isBefore(const LayerPlace& place) { return place.kind > Kind::inserted; }

DVec3 unitOr(const DVec3& v, const DVec3& otherwise) {
  const double length = glm::length(v);
  return length > 1e-6 ? v / length : otherwise;
}

/// The points of a surface, for what is around a place on it.
class PresentSurface {
 public:
  template <class Is, class Position, class Normal>
  PresentSurface(std::span<const LayerPlace> places, const Is& is, const Position& position, const Normal& normal)
      : indices_(parallelCollect(places.size(), 0, is, [](std::size_t i) { return i; })),
        tree_(of(position), of(normal)) {}

  /// Calls use(index, weight) for the nearest points that face so; their weights add up to 1.
  template <class Use>
  void around(const Vec3& at, const Vec3& facing, const Use& use) const {
    constexpr std::size_t kAround = 6;
    std::array<std::pair<std::size_t, double>, kAround> near;
    std::size_t count = 0;
    double sum = 0;
    tree_.visit(at, facing, [&](std::uint32_t k, double squared) {
      near[count] = {indices_[k], 1 / std::max(squared, 1e-30)};
      sum += near[count].second;
      return ++count < kAround;
    });
    for (const auto& [index, weight] : std::span(near).first(count)) use(index, weight / sum);
  }

 private:
  template <class Get>
  BareVector<Vec3> of(const Get& get) const {
    return parallelMake(indices_.size(), 0, [&](std::size_t k) { return get(indices_[k]); });
  }

  BareVector<std::size_t> indices_;
  FacingTree tree_;
};

}  // namespace

std::size_t LayerShape::indexOf(std::uint64_t point) const {
  const auto at = std::ranges::lower_bound(places_, point, {}, &LayerPlace::number);
  return at != places_.end() && at->number == point ? static_cast<std::size_t>(at - places_.begin()) : places_.size();
}

Vec3 LayerShape::presentNormal(std::size_t index, const LayerStrengths& strengths) const {
  return normalAt(index, strengths.of(places_[index].number));
}

void LayerShape::addNew(const PointStates& present, const LayerStrengths& strengths) {
  std::vector<std::pair<const PointState*, Kind>> fresh;
  const std::span<const PointState> added = present.added();
  const auto isFresh = [&](std::size_t i) {
    return !added[i].gone && added[i].parent != added[i].number && indexOf(added[i].number) == places_.size();
  };
  for (const std::size_t i : parallelCollect(added.size(), 0, isFresh, [](std::size_t found) { return found; })) {
    const PointState& state = added[i];
    const auto among =
        std::ranges::lower_bound(fresh, state.parent, {}, [](const auto& of) { return of.first->number; });
    const std::size_t parent = indexOf(state.parent);
    if (among != fresh.end() && among->first->number == state.parent)
      fresh.emplace_back(&state, among->second);
    else if (parent < places_.size())
      fresh.emplace_back(&state, isBefore(places_[parent]) ? places_[parent].kind : Kind::kept);
  }
  if (fresh.empty()) return;
  findSurroundings();
  const PresentSurface surface(
      places_, [&](std::size_t i) { return places_[i].isSeen && !present[places_[i].number].gone; },
      [&](std::size_t i) { return present[places_[i].number].position; },
      [&](std::size_t i) { return present[places_[i].number].normal; });
  std::vector<LayerPlace> made;
  for (const auto& [state, kind] : fresh) {
    DVec3 displacement{0}, now{0}, zero{0}, one{0};
    surface.around(state->position, state->normal, [&](std::size_t i, double weight) {
      displacement += weight * (DVec3(places_[i].one) - DVec3(places_[i].base));
      now += weight * DVec3(presentNormal(i, strengths));
      zero += weight * DVec3(places_[i].zeroNormal), one += weight * DVec3(places_[i].oneNormal);
    });
    if (displacement == DVec3(0)) continue;
    const DVec3 normal(state->normal);
    const auto turned = [&](const DVec3& to) {
      return Vec3(shortestRotation(unitOr(now, normal), unitOr(to, normal)) * normal);
    };
    const Vec3 base(DVec3(state->position) - strengths.of(state->number) * displacement);
    const Vec3 end(DVec3(base) + displacement);
    made.push_back({.number = state->number,
                    .one = end,
                    .oneNormal = turned(one),
                    .base = base,
                    .zero = kind == Kind::kept ? base : end,
                    .zeroNormal = turned(zero),
                    .kind = kind});
  }
  if (made.empty()) return;
  surroundings_.clear();
  moving_.clear();
  places_.insert(places_.end(), made.begin(), made.end());
  std::ranges::sort(places_, {}, &LayerPlace::number);
}

std::unordered_map<std::size_t, PointState> LayerShape::absentWithOthers(const PointStates& present,
                                                                         const LayerStrengths& strengths) const {
  std::unordered_map<std::size_t, PointState> absent;
  const auto expected = [&](std::size_t i) { return positionAt(i, strengths.of(places_[i].number)); };
  const BareVector<std::uint32_t> removed = parallelCollect(
      absentAtSome_.size(), 0, [&](std::size_t k) { return isRemoved(absentAtSome_[k], strengths); },
      [&](std::size_t k) { return absentAtSome_[k]; });
  const auto exists = [&](std::size_t i) { return !present[places_[i].number].gone; };
  const auto isMoved = [&](std::size_t i) { return exists(i) && present[places_[i].number].position != expected(i); };
  if (removed.empty() || parallelCount(places_.size(), 0, isMoved) == 0) return absent;
  const auto normal = [&](std::size_t i) { return presentNormal(i, strengths); };
  const PresentSurface surface(places_, exists, expected, normal);
  for (const std::uint32_t i : removed) {
    DVec3 moved{0}, was{0}, is{0};
    surface.around(expected(i), normal(i), [&](std::size_t k, double weight) {
      const PointState at = present[places_[k].number];
      moved += weight * (DVec3(at.position) - DVec3(expected(k)));
      was += weight * DVec3(normal(k)), is += weight * DVec3(at.normal);
    });
    if (moved == DVec3(0)) continue;
    PointState& state = absent[i] = present[places_[i].number];
    const DVec3 facing(normal(i));
    state.position = Vec3(DVec3(expected(i)) + moved);
    state.normal = Vec3(shortestRotation(unitOr(was, facing), unitOr(is, facing)) * facing);
  }
  return absent;
}

std::uint64_t LayerShape::bytes() const {
  return places_.capacity() * sizeof(LayerPlace) + surroundings_.capacity() * sizeof(Surroundings) +
         nearMerged_.capacity() * sizeof(Near) +
         (absentAtSome_.capacity() + moving_.capacity()) * sizeof absentAtSome_[0] + movingPoints_.bytes();
}

// Normal of the surface, as long as the area there that is one at strength 1, or at 0 of points that exist there alone.
DVec3 LayerShape::areaAt(std::size_t index, double strength) const {
  const LayerPlace& place = places_[index];
  const double from = isBefore(place) ? strength : strength - 1;
  const auto& terms = surroundings_[index].terms;
  return DVec3(isBefore(place) ? place.zeroNormal : place.oneNormal) +
         from * (DVec3(terms[0]) + from * DVec3(terms[1]));
}

// Where points have been drawn apart or together to less than a half, their order is reversed at -1 or 2. What
// overhangs at 1 may do so elsewhere.
bool LayerShape::isFolded(double strength) const {
  constexpr std::size_t kFew = 50;  // one of so many
  const auto moves = [&](std::size_t i) { return places_[i].isSeen && !isBefore(places_[i]) && !isStill(i); };
  const auto isOver = [&](std::size_t i) {
    const DVec3 facing(places_[i].zeroNormal);
    return moves(i) && glm::dot(DVec3(places_[i].oneNormal), facing) > 0 && glm::dot(areaAt(i, strength), facing) < 0;
  };
  const std::size_t over = parallelCount(places_.size(), 0, isOver);
  return over > kNeighbours && over * kFew > parallelCount(places_.size(), 0, moves);
}

void LayerShape::findRange() {
  constexpr double kStep = 0.25;
  range_ = {0, 1};
  while (range_.low > kMinLayerStrength && !isFolded(range_.low - kStep)) range_.low -= kStep;
  while (range_.high < kMaxLayerStrength && !isFolded(range_.high + kStep)) range_.high += kStep;
}

bool LayerShape::isStill(std::size_t index) const {
  const LayerPlace& place = places_[index];
  return !isBefore(place) && place.base == place.one && place.zero == place.one && place.zeroNormal == place.oneNormal;
}

Vec3 LayerShape::positionAt(std::size_t index, double strength) const {
  const LayerPlace& place = places_[index];
  if (isBefore(place)) {
    if (strength == 0) return place.base;
    if (strength == 1) return place.zero;
  }
  if (strength == 0) return place.zero;
  if (strength == 1) return place.one;
  return Vec3(DVec3(place.base) + strength * (DVec3(place.one) - DVec3(place.base)));
}

void LayerShape::findSurroundings() {
  if (surroundings_.size() == places_.size()) return;
  const auto indicesOf = [&](auto&& is) {
    return parallelCollect(
        places_.size(), 0, [&](std::size_t i) { return is(places_[i]); },
        [](std::size_t i) { return static_cast<std::uint32_t>(i); });
  };
  const auto isOther = [](const LayerPlace& place) { return !place.isSeen || isBefore(place); };
  const auto indices = indicesOf([&](const LayerPlace&place) { return !isOther(place); }), others = indicesOf(isOther);
  absentAtSome_ = indicesOf([](const LayerPlace& place) { return place.kind != Kind::kept; });
  surroundings_ = parallelMake(places_.size(), 0, [](std::size_t) { return Surroundings(); });
  nearMerged_.clear();
  for (const std::uint32_t i : absentAtSome_) {
    if (places_[i].kind != Kind::merged) continue;
    surroundings_[i].merged = static_cast<std::uint32_t>(nearMerged_.size());
    nearMerged_.emplace_back();
  }
  range_ = {};
  if (indices.empty()) return;
  const auto all = [&](std::size_t count, Vec3 LayerPlace::*what) {
    return parallelMake(count, 0, [&](std::size_t k) { return places_[indices[k]].*what; });
  };
  const bool hasBefore = std::ranges::any_of(absentAtSome_, [&](std::uint32_t i) { return isBefore(places_[i]); });
  const std::size_t ofBefore = hasBefore ? indices.size() : 0;
  const FacingTree after(all(indices.size(), &LayerPlace::one), all(indices.size(), &LayerPlace::oneNormal)),
      before(all(ofBefore, &LayerPlace::base), all(ofBefore, &LayerPlace::zeroNormal));
  parallelFor(places_.size(), 0, [&](std::size_t begin, std::size_t end) {
    for (std::size_t at = begin; at < end; ++at) {
      const std::uint32_t i = at < indices.size() ? indices[after.order()[at]] : others[at - indices.size()];
      const LayerPlace& place = places_[i];
      if (isStill(i)) continue;
      std::array<std::uint32_t, kNeighbours> near{};
      std::size_t count = 0;
      double sum = 0;
      (isBefore(place) ? before : after)
          .visit(isBefore(place) ? place.base : place.one, isBefore(place) ? place.zeroNormal : place.oneNormal,
                 [&](std::uint32_t k, double squared) {
                   if (indices[k] == i) return true;
                   if (count < kMeanOf) sum += std::sqrt(squared);
                   near[count++] = indices[k];
                   return count < kNeighbours;
                 });
      Surroundings& around = surroundings_[i];
      around.terms = areaTermsOf(i, std::span(near).first(count));
      around.spacing = count > 0 ? static_cast<float>(sum / static_cast<double>(std::min(count, kMeanOf))) : 0;
      if (place.kind == Kind::merged) nearMerged_[around.merged] = {near, count};
    }
  });
  findRange();
}

// From the change of (one - base) along two tangents, by least squares in the tangent plane at the end at which the
// neighbours were found: the cross product of two tangents that change so with the strength.
std::array<Vec3, 2> LayerShape::areaTermsOf(std::size_t index, std::span<const std::uint32_t> near) const {
  const LayerPlace& place = places_[index];
  const auto displacement = [&](const LayerPlace& of) { return DVec3(of.one) - DVec3(of.base); };
  const auto at = [&](const LayerPlace& of) { return DVec3(isBefore(place) ? of.base : of.one); };
  const auto frame = frameAround(DVec3(isBefore(place) ? place.zeroNormal : place.oneNormal));
  double uu = 0, uv = 0, vv = 0;
  DVec3 ofU{0}, ofV{0};
  for (const std::uint32_t k : near) {
    const DVec3 offset = at(places_[k]) - at(place), bend = displacement(places_[k]) - displacement(place);
    const double u = glm::dot(offset, frame.u), v = glm::dot(offset, frame.v);
    uu += u * u, uv += u * v, vv += v * v;
    ofU += u * bend, ofV += v * bend;
  }
  const double determinant = uu * vv - uv * uv;
  constexpr double kLine = 0.02;  // of points in a line
  if (determinant <= kLine * (uu + vv) * (uu + vv) / 4) return {};
  const DVec3 alongU = (vv * ofU - uv * ofV) / determinant, alongV = (uu * ofV - uv * ofU) / determinant;
  return {Vec3(glm::cross(frame.u, alongV) + glm::cross(alongU, frame.v)), Vec3(glm::cross(alongU, alongV))};
}

void LayerShape::findMoving(const std::function<bool(std::uint64_t)>& isStroked) {
  if (!moving_.empty()) return;
  moving_ = parallelCollect(
      places_.size(), 0, [&](std::size_t i) { return !isStill(i) || isStroked(places_[i].number); },
      [](std::size_t i) { return static_cast<std::uint32_t>(i); });
  movingPoints_ = PointSet::of(moving_, [&](std::uint32_t i) { return places_[i].number; });
}

bool LayerShape::isRemoved(std::size_t index, const LayerStrengths& strengths) const {
  const LayerPlace& place = places_[index];
  const double strength = strengths.of(place.number);
  if (place.kind == Kind::kept) return false;
  if (place.kind == Kind::inserted) return strength == 0;
  if (place.kind == Kind::cut) return strength >= kRemovesFrom;
  if (strength == 0) return false;
  if (strength >= 1) return true;
  double nearest = std::numeric_limits<double>::infinity();
  const Near& near = nearMerged_[surroundings_[index].merged];
  for (const std::uint32_t k : std::span(near.indices).first(near.count))
    nearest = std::min(nearest, glm::distance(DVec3(positionAt(index, strength)),
                                              DVec3(positionAt(k, strengths.of(places_[k].number)))));
  const double spacing = static_cast<double>(surroundings_[index].spacing);
  return nearest < kCrowded * spacing || nearest > kApart * spacing;
}

Vec3 LayerShape::normalAt(std::size_t index, double strength) const {
  const LayerPlace& place = places_[index];
  if (strength == 0) return place.zeroNormal;
  if (strength == 1 || isStill(index)) return place.oneNormal;
  const DVec3 known(isBefore(place) ? place.zeroNormal : place.oneNormal);
  const auto at = [&](double s) { return unitOr(areaAt(index, s), known); };
  const double rest = std::clamp(isBefore(place) ? strength : 1 - strength, 0.0, 1.0);
  const DVec3 other(isBefore(place) ? place.oneNormal : place.zeroNormal);
  return Vec3(unitOr(at(strength) + rest * rest * (other - at(isBefore(place) ? 1 : 0)), known));
}

}  // namespace palpate
