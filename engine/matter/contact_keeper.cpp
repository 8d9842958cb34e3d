#include "engine/matter/contact_keeper.hpp"

#include <algorithm>
#include <cmath>

#include "shaders/shared/proxy.h"

namespace palpate {

namespace {

constexpr double kMinTurn = 0.9;          // minimum cosine between the normals of two ticks of a continuous surface
constexpr double kLongestGuess_s = 0.02;  // maximum time that a position is extrapolated with its velocity
constexpr double kMillisecond_s = 1e-3;
// In support radii:
constexpr double kSamePlace = 0.5;    // a proxy that slid farther is borne by other nodes
constexpr double kFirstDepth = 0.25;  // deeper than the hand's displacement plus this, a contact begins at the hand
constexpr double kNear = 0.1;         // a surface of points this near to the kept position is the same surface
constexpr double kSlideOfWay = 2;     // maximum slide of a proxy relative to the hand's displacement

DVec3 acrossOf(const DVec3& way, const DVec3& normal) { return way - glm::dot(way, normal) * normal; }

}  // namespace

void ContactKeeper::forget() { touching_ = isKept_ = isElsewhere_ = gaveWay_ = false; }

// A contact begins where the hand reaches the surface. A contact that begins far from the surface begins at the hand.
void ContactKeeper::begin(const Contact& felt, const Tick& tick, double allowed) {
  forget();
  if (!felt.touching) return;
  touching_ = true;
  contact_ = std::max(1u, contact_ + 1);
  last_ = felt;
  const double depth = glm::distance(felt.proxy, tick.hip);
  if (depth <= allowed + way_ + kFirstDepth * tick.radius) return;
  last_.proxy = tick.hip + allowed * felt.normal;
  isKept_ = sticks_ = true;
  slid_ = 0;
}

// A sliding proxy may move along the normal by as much as it moves tangentially.
bool ContactKeeper::goesOn(const Contact& felt, const DVec3& expected, double allowed) const {
  const DVec3 apart = felt.proxy - expected;
  const double along = std::min(glm::length(acrossOf(apart, last_.normal)), allowed + kSlideOfWay * way_);
  return glm::dot(felt.normal, last_.normal) > kMinTurn && std::abs(glm::dot(apart, last_.normal)) <= allowed + along;
}

Contact ContactKeeper::follow(const Contact& felt, const PressedPlace& pressed, const Tick& tick) {
  const double since_s = std::max(0.0, tick.time_s - lastTime_s_);
  const double allowed = tick.slack * std::max(1.0, since_s / kMillisecond_s);
  way_ = glm::distance(tick.hip, lastHip_);
  gaveWay_ = false;
  Contact contact = felt;
  if (!touching_) {
    begin(felt, tick, allowed);
    if (touching_) contact = last_;
  } else {
    contact = goOn(felt, placeNow(pressed, tick, since_s), tick, {.since_s = since_s, .allowed = allowed});
  }
  if (!isKept_ || pressed.contact != contact_) place_ = contact.proxy;
  lastHip_ = tick.hip;
  lastTime_s_ = tick.time_s;
  return contact;
}

// Position of the contact now; until the body has it, the extrapolated surface position.
PressedPlace ContactKeeper::placeNow(PressedPlace place, const Tick& tick, double since_s) const {
  if (place.contact != contact_)
    return {.contact = contact_, .place = last_.proxy + since_s * last_.velocity, .velocity = last_.velocity};
  place.place += std::clamp(tick.time_s - place.time_s, -kLongestGuess_s, kLongestGuess_s) * place.velocity;
  return place;
}

Contact ContactKeeper::goOn(const Contact& felt, const PressedPlace& pressed, const Tick& tick, const Step& step) {
  if (!felt.fresh && !isKept_) {  // bridged: no information about the surface
    touching_ = felt.touching;
    return last_ = felt;
  }
  const DVec3 expected = last_.proxy + step.since_s * last_.velocity;
  const bool isSmooth = goesOn(felt, expected, step.allowed) || (!isKept_ && goesOn(felt, pressed.place, step.allowed));
  if (felt.touching && isSmooth) {
    isKept_ = isElsewhere_ = false;
    return last_ = felt;
  }
  const bool isOut = !felt.touching && !felt.isWithin;
  if (isOut && glm::dot(pressed.place - tick.hip, last_.normal) <= step.allowed) {
    forget();
    return felt;
  }
  return kept(felt, pressed, tick, step);
}

// Depth of the hand below the position that the body carries, and below the one that the hand feels.
ContactKeeper::Depths ContactKeeper::depthsBelow(const Contact& felt, const PressedPlace& pressed, const Tick& tick,
                                                 double allowed) {
  const DVec3 normal = last_.normal;
  const double way = glm::dot(tick.hip - lastHip_, normal);  // displacement of the hand, outward
  const double before = glm::dot(last_.proxy - lastHip_, normal);
  const double least = before - std::max(0.0, way) - allowed, most = before + std::max(0.0, -way) + allowed;
  double there = glm::dot(pressed.place - tick.hip, normal);
  gaveWay_ = pressed.isAlone || there < least;
  if (pressed.isAlone) return {.pressed = least, .felt = least};
  // Returns to the surface of points if that is near.
  const double ofPoints = glm::dot(felt.proxy - tick.hip, normal);
  if (felt.touching && glm::dot(felt.normal, normal) > kMinTurn && std::abs(ofPoints - there) < kNear * tick.radius)
    there = std::clamp(ofPoints, there - allowed, there + allowed);
  return {.pressed = there, .felt = std::clamp(there, least, most)};
}

Contact ContactKeeper::kept(const Contact& felt, const PressedPlace& pressed, const Tick& tick, const Step& step) {
  if (!isKept_) slid_ = 0, sticks_ = true;
  const DVec3 normal = last_.normal;
  const Depths depths = depthsBelow(felt, pressed, tick, step.allowed);
  if (!(depths.felt > 0)) {
    forget();
    Contact free = felt;
    free.touching = false;
    free.proxy = tick.hip;
    return free;
  }
  const DVec3 spring = depths.felt * normal + acrossOf(pressed.place - tick.hip, normal);
  const DVec3 slide = shared::slideAlong(normal, spring, tick.friction, sticks_);
  sticks_ = slide == DVec3(0);
  slid_ += glm::length(slide);
  isKept_ = true;
  isElsewhere_ = slid_ > kSamePlace * tick.radius;
  if (isElsewhere_) slid_ = 0;
  last_ = felt;
  last_.proxy = tick.hip + spring + slide;
  last_.normal = normal;
  last_.touching = true;
  last_.isWithin = false;
  last_.velocity = pressed.velocity;
  place_ = last_.proxy + (depths.pressed - depths.felt) * normal;
  return last_;
}

}  // namespace palpate
