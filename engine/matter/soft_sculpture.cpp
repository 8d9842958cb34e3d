#include "engine/matter/soft_sculpture.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/core/check.hpp"
#include "shaders/shared/weight.h"

namespace palpate {

namespace {

// Sum of the weights of positions on a plane, at the distances of a surface's.
double weightOfPlane(double reach_spacings) {
  const double apart = 1.0 / kPlacesOfSpacing;
  return static_cast<double>(0.448798950512827605) * std::pow(reach_spacings / apart, 2);
}

bool isIn(const DVec3& place, const DVec3& low, const DVec3& high) {
  return glm::all(glm::lessThanEqual(low, place)) && glm::all(glm::lessThanEqual(place, high));
}

}  // namespace

std::vector<SoftSculpture::Near> SoftSculpture::placesNear(const DVec3& low, const DVec3& high,
                                                           std::span<const PlaceWay> ways) const {
  std::vector<DVec3> wayOf(surface_.size(), DVec3(0));
  for (const PlaceWay& way : ways) wayOf[way.place] = way.way;
  std::vector<Near> near;
  for (std::size_t i = 0; i < surface_.size(); ++i)
    if (const Vec3 place = surface_.placeOf(body_, i); isIn(DVec3(place), low, high))
      near.push_back({.place = place, .way = wayOf[i]});
  return near;
}

std::size_t SoftSculpture::yield(std::span<const PlaceWay> ways) {
  if (ways.empty()) return 0;
  if (began_.empty()) began_.assign(body_.rest().displacements().begin(), body_.rest().displacements().end());
  const double reach = kReach_spacings * body_.lattice().spacing_m();
  const double plane = weightOfPlane(kReach_spacings);
  DVec3 low(std::numeric_limits<double>::infinity()), high = -low;
  for (const PlaceWay& way : ways) {
    const DVec3 place(surface_.placeOf(body_, way.place));
    low = glm::min(low, place - reach);
    high = glm::max(high, place + reach);
  }
  const std::vector<Near> places = placesNear(low - reach, high + reach, ways);
  std::vector<RestPlace> moves;
  for (std::uint32_t node = 0; node < body_.size(); ++node) {
    const DVec3 at = DVec3(body_.lattice().rest()[node]) + DVec3(body_.displacements()[node]);
    if (!isIn(at, low, high)) continue;
    double weights = 0;
    DVec3 sum(0);
    for (const Near& near : places) {
      const double away = glm::length(DVec3(near.place) - at);
      if (!(away < reach)) continue;
      const double weight = shared::wendland(away / reach);
      weights += weight;
      sum += weight * near.way;
    }
    const Vec3 way(sum / std::max(weights, plane));
    if (way != Vec3(0)) moves.push_back({.node = node, .moved = way});
  }
  return body_.yield(moves);
}

void SoftSculpture::endStroke() {
  if (began_.empty()) return;
  ShapeStroke stroke;
  const std::span<const Vec3> now = body_.rest().displacements();
  for (std::uint32_t node = 0; node < now.size(); ++node)
    if (now[node] != began_[node]) stroke.places.push_back({.node = node, .moved = began_[node]});
  began_.clear();
  if (stroke.places.empty()) return;
  const std::scoped_lock hold(lock_);
  ended_.push_back(std::move(stroke));
}

void SoftSculpture::take(std::vector<ShapeStroke>& strokes) {
  const std::scoped_lock hold(lock_);
  for (ShapeStroke& stroke : ended_) strokes.push_back(std::move(stroke));
  ended_.clear();
}

void SoftSculpture::exchange(ShapeStroke& stroke) {
  PALPATE_CHECK(began_.empty());
  std::vector<RestPlace> present = stroke.places;
  for (RestPlace& place : present) place.moved = body_.rest().displacements()[place.node];
  body_.putRest(stroke.places);
  stroke.places = std::move(present);
}

}  // namespace palpate
