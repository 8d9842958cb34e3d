#include "engine/core/brush_stroke.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/core/point_state.hpp"
#include "shaders/shared/contact.h"

namespace palpate {

namespace {

constexpr double kGap_s = 0.3;        // longest time without contact within one stroke
constexpr double kTick_s = 1e-3;      // the interval that a brush's strength and push rate refer to
constexpr double kMaxTicks = 16;      // maximum number of ticks that one edit makes up for
constexpr double kWithdrawing = 0.5;  // cosine between motion and direction to the proxy above which a hand withdraws
// In brush radii: the tool's longest and shortest step between two edits, and the spacing of the remembered positions
// of its path. Lower values cost edits, higher ones leave ripples.
constexpr double kLongestStep = 0.25, kShortestStep = 1.0 / 256, kWayStep = 1.0 / 16;
// Number of e-foldings by which a point's remaining distance shrinks while the tool passes over it.
constexpr double kDecays = 1.5, kPushDecays = 3;
// Times that an edit may move a point by its share, under a hand so quick that it would pass before the point has
// yielded.
constexpr double kQuickTimes = 5;
// In brush radii: if the hand moves further than this without the surface yielding, the tool skips the path in between.
constexpr double kJump = 0.5;
constexpr double kShaftMargin = 0.25;  // in brush radii, over the surface as the stroke found it
constexpr double kMaxShaft = 2;        // in brush radii
// In brush radii: maximum distance of the ends of the tool's reach, without the ball at each end.
constexpr double kMaxLength = 2.9;
// The surface is measured by the points in a ball of the brush's radius, kHeardOver radii over the hand, that the
// stroke found no further from the hand than kHearing times its depth.
constexpr double kHeardOver = 1.0 / 3, kHearing = 1.3;
// In brush radii: inflate measures the smallest possible neighbourhood, since a wide piece of a curved surface lies
// lower than its centre, and the height that counts is that of the centre.
constexpr double kInflateHears = 0.5;
constexpr double kMaxHeld = 1.9, kMaxHeldAside = 0.5;  // in brush radii: how far grab moves the points it holds
constexpr double kStill = 1e-9;     // in brush radii: a hand that has moved no more has not moved but by rounding
constexpr double kMaxRaised = 0.9;  // in brush radii; more would raise points out of the brush's reach
// Side of the cells of the grid of the surface: of the support radius, within which neighbours define the surface, at
// least, and of the brush's radius, so that the grid contains the brush's ball.
constexpr double kCellOfSupport = 0.5, kCellOfRadius = 1.0 / 7;
// Cosines between the outward directions of the surface under the hand and of the side on which the stroke is: with
// less than the first the hand has broken through to another side, until there is more than the second.
constexpr double kOtherSide = -0.3, kSameSide = 0.3;
constexpr double kStraight = 0.7;   // cosine: other surfaces are not those that a cut goes on in
constexpr double kSideTurn = 2;     // of the side, in radians for each brush radius that the hand moves
constexpr double kElsewhere = 2;    // in brush radii: farther from where it broke through, every side is a new one
constexpr double kMinLength = 0.3;  // shortest mean normal that is meaningful
constexpr double kMaxMeasured = 8192;
// Number of edits without the brush after which no point is inserted any more: filling every gap takes far fewer, and
// from then on each change removes a point, so that the points come to rest.
constexpr std::uint32_t kMaxFilling = 256;
// In support radii: the tool waits while a point has moved this far since it was last resampled. A gap as wide as the
// support radius would count as a border.
constexpr double kMaxStrain = 0.5;

// Outward direction of the surface that a hand touches. Touched from behind, it points to the hand's side.
DVec3 outwardOf(const Contact& contact, const DVec3& spring) {
  const double length = glm::length(spring);
  const DVec3 springs = length > 0 ? spring / length : DVec3(0, 0, 1);
  if (!(glm::length(contact.normal) > 0.5)) return springs;
  const DVec3 normal = glm::normalize(contact.normal);
  return glm::dot(normal, springs) < 0 ? springs : normal;
}

double asSigned(std::uint32_t sum) { return static_cast<double>(static_cast<std::int32_t>(sum)); }

double normalSteps() { return static_cast<double>(shared::kNormalSteps); }

}  // namespace

void BrushStroke::setBrush(const BrushOptions& brush) {
  end();
  brush_ = brush;
}

void BrushStroke::end() {
  open_ = acts_ = false;
  wayCount_ = 0;
}

void BrushStroke::awaitRelease() {
  end();
  awaitsRelease_ = true;
}

void BrushStroke::restart() {
  BrushStroke fresh(support_);
  fresh.brush_ = brush_;
  fresh.number_ = number_;
  *this = fresh;
}

void BrushStroke::lift() {
  acts_ = knowsLast_ = false;
  isLifted_ = true;
}

void BrushStroke::feel(const Contact& contact, const DVec3& hip, const DVec3& spring, Press press, double time_s) {
  const DVec3 motion = knowsLast_ ? hip - lastHip_ : DVec3(0);
  knowsLast_ = true;
  lastHip_ = hip;
  const bool isReleased = press == Press::none || (press == Press::contact && !contact.touching);
  awaitsRelease_ = awaitsRelease_ && !isReleased;
  const bool sculpts = press != Press::none && !awaitsRelease_, touches = contact.touching && sculpts;
  const bool yields = touches && glm::length(spring) > brush_.yieldDepth;
  // A contact that ends while the hand is still behind the surface has not been lifted from its side.
  const bool fellThrough = yielded_ && !touches && glm::dot(hip - side_.found, side_.outward) < 0;
  const bool keepsSide = has(shared::kLooksAhead);  // carve may go through
  brokeThrough_ = sculpts && keepsSide && (brokeThrough_ || fellThrough);
  yielded_ = yields;
  const bool wasLifted = !touched_ && time_s - lastTouch_s_ > kGap_s;
  if (touches) lastTouch_s_ = time_s;
  touched_ = touches;
  const bool holds = has(shared::kHoldsPoints) && open_ && sculpts;
  if (!sculpts || (press == Press::contact && !holds && wasLifted)) open_ = false;
  Place place{.hip = hip, .jumps = !acts_, .outward = outwardOf(contact, spring), .found = hip + spring};
  if (touches && keepsSide && (open_ || brokeThrough_)) noteSide(place);
  if (yields && !isGoingOn() && !brokeThrough_) begin(place);
  // Withdraws: moves towards the proxy. A hand that moves sideways does not, although the proxy trails behind it.
  const bool withdraws = !has(shared::kHoldsPoints) && motion != DVec3(0) &&
                         glm::dot(motion, spring) > kWithdrawing * glm::length(motion) * glm::length(spring);
  // What removes points goes on where it has cut through a thin part, below the surface as it was and along its normal,
  // also where the hand has come to something else.
  cutsOn_ = has(shared::kRemovesPoints) && press == Press::button && open_ && sculpts && !yields &&
            (!touches || motion != DVec3(0)) && isBelow(hip);
  if (cutsOn_) place.outward = outward_, place.found = foundAt_;
  acts_ = open_ && (holds || cutsOn_ || (yields && !brokeThrough_)) && !withdraws;
  if (acts_) goOnTo(place);
}

// Below the surface that the stroke found last, and not beyond the reach of a tool there.
bool BrushStroke::isBelow(const DVec3& hip) const {
  const DVec3 way = foundAt_ - hip;
  const double depth = glm::dot(way, outward_);
  return depth > 0 && depth < kMaxShaft * brush_.radius && glm::distance(way, depth * outward_) < brush_.radius;
}

void BrushStroke::begin(const Place& place) {
  open_ = true;
  edited_ = false;
  ++number_;
  outward_ = place.outward;
  foundAt_ = heldAt_ = touchedAt_ = place.found;
  place_ = heldFrom_ = place.hip;
  wayCount_ = 0;
  isLifted_ = brokeThrough_ = false;
  side_ = place;
  beginSheet();
}

// The side turns with the surface under the hand, unless the surface is more strongly curved than the brush: a hand
// that has gone through a thin part, or around its rim, is at another side, where the stroke would undo this one. Its
// contact may end there; the other side remains the wrong one until the hand is elsewhere.
void BrushStroke::noteSide(const Place& place) {
  const double cosine = glm::dot(place.outward, side_.outward), way = glm::distance(place.hip, side_.hip);
  const bool isElsewhere = brokeThrough_ && way > kElsewhere * brush_.radius;
  brokeThrough_ = !isElsewhere && cosine < (brokeThrough_ ? kSameSide : kOtherSide);
  if (brokeThrough_) return;
  const double turn = std::acos(std::clamp(cosine, -1.0, 1.0)), mostTurn = kSideTurn * way / brush_.radius;
  const DVec3 aside = place.outward - cosine * side_.outward;
  side_.hip = place.hip;
  side_.found = place.found;
  if (isElsewhere || turn <= mostTurn || !(glm::length(aside) > 0))
    side_.outward = place.outward;
  else
    side_.outward = std::cos(mostTurn) * side_.outward + std::sin(mostTurn) * glm::normalize(aside);
}

void BrushStroke::goOnTo(const Place& place) {
  const auto at = [&](std::size_t k) -> Place& { return way_[(wayFirst_ + k) % kMaxWay]; };
  const auto hipAt = [&](std::size_t back) { return wayCount_ < back ? place_ : at(wayCount_ - back).hip; };
  const bool isFar = std::exchange(isLifted_, false) || glm::distance(hipAt(1), place.hip) > kJump * brush_.radius;
  const bool jumps = place.jumps && !has(shared::kHoldsPoints) && isFar;
  // The last position follows the hand as long as it is near the position before it.
  if (!jumps && wayCount_ > 0 && glm::distance(hipAt(2), place.hip) < kWayStep * brush_.radius) {
    at(wayCount_ - 1).hip = place.hip;
    at(wayCount_ - 1).found = place.found;
    return;
  }
  if (wayCount_ == kMaxWay) {
    const bool skipsJump = at(0).jumps;
    wayFirst_ = (wayFirst_ + 1) % kMaxWay;
    --wayCount_;
    at(0).jumps |= skipsJump;
  }
  at(wayCount_) = place;
  at(wayCount_++).jumps = jumps;
}

// Of the tool where it is in the surface.
double BrushStroke::halfWidth() const {
  const double radius = brush_.radius, depth = std::max(found() - brush_.yieldDepth, 0.1 * radius);
  const double low = std::min(depth, radius);
  return std::sqrt(radius * radius - (radius - low) * (radius - low));
}

// A tool that passes over a point must leave it the time to yield: each edit moves the point a share of its path.
double BrushStroke::longestStep(double share) const {
  const double radius = brush_.radius, depth = std::max(found() - brush_.yieldDepth, 0.1 * radius);
  const double yield = static_cast<double>(shared::kLongestMove) * support_;
  const double decays = has(shared::kUsesPushRate) ? kPushDecays : kDecays;
  const double most = std::min({kLongestStep * radius, yield * std::clamp(radius / depth, 0.25, 2.0),
                                share > 0 ? share * halfWidth() / decays : kLongestStep * radius});
  return std::max(most, kShortestStep * radius);
}

// A quick hand pushes as deep as a slow one: points yield the faster the less time it leaves them.
double BrushStroke::pushShare(double share) const {
  double ahead = 0;
  DVec3 from = place_;
  for (std::size_t k = 0; k < wayCount_ && !way_[(wayFirst_ + k) % kMaxWay].jumps; ++k) {
    const DVec3& to = way_[(wayFirst_ + k) % kMaxWay].hip;
    ahead += glm::distance(from, to);
    from = to;
  }
  const double most = 1 - std::pow(1 - share, kQuickTimes), step = std::min(ahead, longestStep(most));
  return std::max(share, std::min(kPushDecays * step / halfWidth(), most));
}

void BrushStroke::advance(double most) {
  for (bool moved = false; wayCount_ > 0; moved = true) {
    const Place& to = way_[wayFirst_];
    const double length = glm::distance(place_, to.hip);
    if (to.jumps) {
      if (moved) return;  // the jump is left to the next edit
      outward_ = to.outward;
      foundAt_ = to.found;
      beginSheet();
    } else if (length > most) {
      place_ += (most / length) * (to.hip - place_);
      touchedAt_ += (most / length) * (to.found - touchedAt_);
      return;
    } else {
      most -= length;
    }
    place_ = to.hip;
    touchedAt_ = to.found;
    wayFirst_ = (wayFirst_ + 1) % kMaxWay;
    --wayCount_;
  }
}

std::uint32_t BrushStroke::sampling() const {
  const double across = static_cast<double>(shared::kSupportSpacings) * brush_.radius / support_;
  return static_cast<std::uint32_t>(std::clamp(std::ceil(std::log2(3.2 * across * across / kMaxMeasured)), 0.0, 31.0));
}

double BrushStroke::sheetCell() const { return std::max(kCellOfSupport * support_, kCellOfRadius * brush_.radius); }

// The grid is around the surface under the hand.
DVec3 BrushStroke::sheetCorner() const {
  const DVec3& middle = has(shared::kHoldsPoints) ? heldAt_ : foundAt_;
  return middle - 0.5 * shared::kSheetSide * sheetCell();
}

void BrushStroke::beginSheet() {
  measuredSheet_ = false;
  connectedFrom_ = sheetCorner();
  connected_ = cellsAround(shared::sheetPlace(connectedFrom_, sheetCell(), foundAt_, outward_));
}

const BrushStroke::Tool& BrushStroke::next(double time_s, const Backlog& backlog) {
  tool_ = {};
  tool_.stroke = number_;
  if (acts()) idleEdits_ = 0;
  if (!acts() && !backlog.waits) idleEdits_ = std::min(idleEdits_ + 1, kMaxFilling);
  tool_.closes = idleEdits_ == kMaxFilling;
  if (!acts()) return tool_;
  const double since_s = edited_ ? time_s - lastEdit_s_ : kTick_s;
  lastEdit_s_ = time_s;
  edited_ = true;
  const double ticks = std::clamp(std::round(since_s / kTick_s), 1.0, kMaxTicks);
  const bool raises = has(shared::kRaisesSurface), pushes = has(shared::kUsesPushRate);
  const double strength = pushes ? brush_.pushRate : brush_.strength;
  tool_.share = raises ? strength * ticks : 1 - std::pow(1 - strength, ticks);
  if (pushes) tool_.share = pushShare(tool_.share);
  const double step =
      has(shared::kHoldsPoints) ? std::numeric_limits<double>::infinity() : longestStep(raises ? 1 : tool_.share);
  advance(backlog.waits ? std::min(step, std::max(0.0, kMaxStrain - backlog.strain) * support_) : step);
  placeTool();
  return tool_;
}

// Limited sideways to the distance that the surface can follow without folding over, and in all to the one that its
// parts ahead can: less where a limb is pushed into itself or a wall of a crease is near.
DVec3 BrushStroke::held() const {
  const DVec3 way = place_ - heldFrom_;
  if (glm::length(way) < kStill * brush_.radius) return DVec3(0);
  const double along = glm::dot(way, outward_);
  const DVec3 aside = way - along * outward_;
  const double length = glm::length(aside), mostAside = kMaxHeldAside * brush_.radius;
  const double most = kMaxHeld * brush_.radius;
  const DVec3 held =
      std::clamp(along, -most, most) * outward_ + (length > mostAside ? mostAside / length : 1.0) * aside;
  return held / std::max(1.0, steepestAhead(held));
}

// How much less far a point is moved than one behind it, at most, as a share of their distance: over 1 the surface
// would fold over or go through itself. By the connected cells, where the stroke found them.
double BrushStroke::steepestAhead(const DVec3& motion) const {
  const double length = glm::length(motion), radius = brush_.radius;
  if (!measuredSheet_ || !(length > 0)) return 0;
  const DVec3 ahead = motion / length;
  const double cellSide = sheetCell() / radius, falloff = brush_.falloff;
  const DVec3 corner = (connectedFrom_ - heldAt_) / radius + shared::kSheetInside * cellSide * outward_;
  double steepest = 0;
  for (shared::uint cell = 0; cell < shared::kSheetCells; ++cell) {
    if (!hasCell(connected_, cell)) continue;
    const DVec3 middle = corner + cellSide * sheetCellMiddle(cell);
    const double squared = glm::dot(middle, middle), along = glm::dot(middle, ahead);
    if (squared >= 1) continue;
    const double front = std::min(along + 0.5 * cellSide, std::sqrt(1 - squared + along * along));
    steepest = std::max(steepest, 2 * falloff * std::pow(1 - squared, falloff - 1) * front * length / radius);
  }
  return steepest;
}

void BrushStroke::placeTool() {
  const double radius = brush_.radius, height = found();
  const bool holds = has(shared::kHoldsPoints), raises = has(shared::kRaisesSurface);
  tool_.acts = 1;
  tool_.outward = outward_;
  tool_.sampling = sampling();
  tool_.hand = place_;
  tool_.cell = sheetCell();
  tool_.touched = holds ? heldAt_ : touchedAt_;
  tool_.entersFrom = sheetCorner();
  tool_.connectedFrom = connectedFrom_;
  tool_.connected = connected_;
  const double hears = raises ? std::clamp(support_, kInflateHears * radius, radius) : radius;
  tool_.hearing = std::clamp(kHearing * height, hears, static_cast<double>(shared::kMaxHeight) * radius);
  if (holds) {
    tool_.center = heldAt_;
    tool_.motion = held();
    tool_.middle = heldAt_ + 0.5 * tool_.motion;
    tool_.reach = radius + 0.5 * glm::length(tool_.motion);
    return;
  }
  // The tool's reach lies along its axis, over the hand.
  const double heard = kHeardOver * radius;
  double first = height;
  if (has(shared::kHasShaft)) {
    first = brush_.yieldDepth + radius;
    tool_.height = std::max(0.0, height - brush_.yieldDepth);
    if (height > first) tool_.shaft = std::min(height - first + kShaftMargin * radius, kMaxShaft * radius);
  } else if (raises) {
    tool_.height = std::clamp(height - brush_.yieldDepth, 0.0, kMaxRaised * radius);
  }
  const double longest = kMaxLength * radius;
  first = std::clamp(first, heard - longest, heard + longest);
  const double last = std::min(first + tool_.shaft, heard + longest), low = std::min(first, heard);
  tool_.shaft = last - first;
  tool_.center = place_ + first * outward_;
  tool_.middle = place_ + 0.5 * (low + std::max(last, heard)) * outward_;
  tool_.reach = radius + 0.5 * (std::max(last, heard) - low);
}

void BrushStroke::note(const SurfaceMeasure& measure) {
  if (tool_.acts == 0 || tool_.stroke != number_) return;
  takeIn(measure);
  if (measure.nearest == shared::kOutsideSheet) return;
  measuredSheet_ = true;
  connectedFrom_ = tool_.entersFrom;
  connected_ = connectedCells(measure.seen, measure.nearest % shared::kSheetCells);
}

void BrushStroke::takeIn(const SurfaceMeasure& measure) {
  const double weights = asSigned(measure.weights);
  if (!(weights > 0)) return;
  const DVec3 mean = DVec3(asSigned(measure.normals[0]), asSigned(measure.normals[1]), asSigned(measure.normals[2])) /
                     (weights * normalSteps());
  const double height = asSigned(measure.heights) / (weights * static_cast<double>(shared::kHeightSteps));
  // Implausible sums have wrapped around.
  const double length = glm::length(mean);
  if (!(length > kMinLength && length < 1.01 && std::abs(height) <= static_cast<double>(shared::kMaxHeight))) return;
  if (cutsOn_ && glm::dot(mean, outward_) < kStraight * length) return;
  foundAt_ = tool_.hand + height * brush_.radius * tool_.outward;
  if (!has(shared::kHoldsPoints) && !cutsOn_) outward_ = mean / length;
}

}  // namespace palpate
