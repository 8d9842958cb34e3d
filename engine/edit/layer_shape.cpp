#include "engine/edit/layer_shape.hpp"

#include <cmath>
#include <limits>

#include "engine/core/parallel.hpp"
#include "engine/edit/facing_tree.hpp"

namespace palpate {

namespace {

using Kind = LayerPlace::Kind;

constexpr std::size_t kMeanOf = 6;               // neighbours whose mean distance is the spacing
constexpr double kCrowded = 0.75, kApart = 1.5;  // from the next point, spacings

// It is on the surface before the strokes alone.
bool isBefore(const LayerPlace& place) { return place.kind > Kind::inserted; }

bool isStill(const LayerPlace& place) {
  return !isBefore(place) && place.base == place.one && place.zero == place.one && place.zeroNormal == place.oneNormal;
}

DVec3 unitOr(const DVec3& v, const DVec3& otherwise) {
  const double length = glm::length(v);
  return length > 1e-6 ? v / length : otherwise;
}

}  // namespace

std::size_t LayerShape::indexOf(std::uint64_t point) const {
  const auto at = std::ranges::lower_bound(places_, point, {}, &LayerPlace::number);
  return at != places_.end() && at->number == point ? static_cast<std::size_t>(at - places_.begin()) : places_.size();
}

void LayerShape::addNew(const PointStates& present, const LayerStrengths& strengths) {
  std::vector<LayerPlace> fresh;
  for (const PointState& state : present) {
    if (state.gone || state.parent == state.number || indexOf(state.number) < places_.size()) continue;
    const auto among = std::ranges::lower_bound(fresh, state.parent, {}, &LayerPlace::number);
    const std::size_t parent = indexOf(state.parent);
    const bool isAmong = among != fresh.end() && among->number == state.parent;
    if (!isAmong && parent == places_.size()) continue;
    const LayerPlace& of = isAmong ? *among : places_[parent];
    const DVec3 displacement = DVec3(of.one) - DVec3(of.base);
    if (isBefore(of) || displacement == DVec3(0)) continue;
    const Vec3 base(DVec3(state.position) - strengths.of(of.number) * displacement);
    fresh.push_back({.number = state.number,
                     .one = Vec3(DVec3(base) + displacement),
                     .oneNormal = state.normal,
                     .base = base,
                     .zero = base,
                     .zeroNormal = state.normal});
  }
  if (fresh.empty()) return;
  surroundings_.clear();
  places_.insert(places_.end(), fresh.begin(), fresh.end());
  std::ranges::sort(places_, {}, &LayerPlace::number);
}

std::uint64_t LayerShape::bytes() const {
  return places_.capacity() * sizeof(LayerPlace) + surroundings_.capacity() * sizeof(Surroundings) +
         nearMerged_.capacity() * sizeof(Near);
}

bool LayerShape::isTorn() const {
  constexpr std::size_t kFew = 100;  // one of so many
  const auto torn = static_cast<std::size_t>(std::ranges::count(places_, 1, &LayerPlace::isTorn));
  return torn > places_.size() / kFew;
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
  std::vector<Vec3> ones, oneNormals, bases, zeroNormals;
  std::vector<std::uint32_t> indices;
  for (std::uint32_t i = 0; i < places_.size(); ++i) {
    const LayerPlace& place = places_[i];
    if (!place.isSeen || isBefore(place)) continue;
    ones.push_back(place.one), oneNormals.push_back(place.oneNormal);
    bases.push_back(place.base), zeroNormals.push_back(place.zeroNormal);
    indices.push_back(i);
  }
  surroundings_.assign(places_.size(), {});
  nearMerged_.clear();
  for (std::size_t i = 0; i < places_.size(); ++i) {
    if (places_[i].kind != Kind::merged) continue;
    surroundings_[i].merged = static_cast<std::uint32_t>(nearMerged_.size());
    nearMerged_.emplace_back();
  }
  if (indices.empty()) return;
  const FacingTree after(std::move(ones), std::move(oneNormals)), before(std::move(bases), std::move(zeroNormals));
  std::vector<std::uint32_t> order;
  order.reserve(places_.size());
  for (const std::uint32_t k : after.order()) order.push_back(indices[k]);
  for (std::uint32_t i = 0; i < places_.size(); ++i)
    if (!places_[i].isSeen || isBefore(places_[i])) order.push_back(i);
  parallelFor(order.size(), 0, [&](std::size_t begin, std::size_t end) {
    for (std::size_t at = begin; at < end; ++at) {
      const std::uint32_t i = order[at];
      const LayerPlace& place = places_[i];
      if (isStill(place)) continue;
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
      around.bends = bendsOf(i, std::span(near).first(count));
      around.spacing = count > 0 ? static_cast<float>(sum / static_cast<double>(std::min(count, kMeanOf))) : 0;
      if (place.kind == Kind::merged) nearMerged_[around.merged] = {near, count};
    }
  });
}

// By least squares in the tangent plane at the end at which the neighbours were found.
std::array<Vec3, 2> LayerShape::bendsOf(std::size_t index, std::span<const std::uint32_t> near) const {
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
  return {Vec3((vv * ofU - uv * ofV) / determinant), Vec3((uu * ofV - uv * ofU) / determinant)};
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
  if (strength == 1 || isStill(place)) return place.oneNormal;
  const DVec3 known(isBefore(place) ? place.zeroNormal : place.oneNormal);
  const auto frame = frameAround(known);
  const auto& bends = surroundings_[index].bends;
  const auto at = [&](double s) {
    const double from = isBefore(place) ? s : s - 1;
    return unitOr(glm::cross(frame.u + from * DVec3(bends[0]), frame.v + from * DVec3(bends[1])), known);
  };
  const double rest = std::clamp(isBefore(place) ? strength : 1 - strength, 0.0, 1.0);
  const DVec3 other(isBefore(place) ? place.oneNormal : place.zeroNormal);
  return Vec3(unitOr(at(strength) + rest * rest * (other - at(isBefore(place) ? 1 : 0)), known));
}

}  // namespace palpate
