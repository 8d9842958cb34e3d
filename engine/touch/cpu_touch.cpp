#include "engine/touch/cpu_touch.hpp"

#include "engine/cloud/edited_cloud.hpp"
#include "engine/core/counted.hpp"
#include "engine/core/error.hpp"
#include "engine/core/processor.hpp"
#include "shaders/shared/motion.h"

#include <algorithm>

namespace palpate {

namespace {

HashGrid gridFor(const PointCloud& cloud, const CpuTouchOptions& options) {
  const PointExtent extent = options.extent.value_or(PointExtent{.bounds = boundsOf(cloud), .points = cloud.size()});
  return makeHashGrid(Vec3(extent.bounds.min), options.cell > 0 ? options.cell : options.radius, extent.points,
                      options.bucketKey);
}

SculptOptions sculptOptions(const CpuTouchOptions& options) {
  return {.radius = options.radius / options.widening,
          .index = options.index,
          .threads = options.threads,
          .measures = options.brush.has_value()};
}

}  // namespace

CpuTouch::CpuTouch(const PointCloud& cloud, const CpuTouchOptions& options)
    : options_(options),
      origin_(cloud.origin),
      sculpture_(cloud, gridFor(cloud, options), sculptOptions(options)),
      surface_{.radius = options.radius,
               .kind = options.surface,
               .localRadius = options.localRadius,
               .widening = options.widening},
      edits_(sculpture_, options.brush,
             {.radius = options.radius / options.widening,
              .origin = origin_,
              .size = options.editSize,
              .room = options.editRoom}) {
  if (options.source) frames_.emplace(*options.source, gridFor(cloud, options), options.threads);
  for (const ProbeGroup& group : makeProbeGroups(options.tools)) {
    const std::vector<ProxyTracker> trackers(group.probes(), ProxyTracker(options.radius, options.friction));
    hands_.push_back({.probes = group, .trackers = trackers, .bridge = makeBridge(), .before = trackers});
  }
  answers_.resize(hands_.size());
  bridgeTimes_us_.reserve(kEditTimesKept);
  const std::size_t threads = sculpture_.threads();
  machine_ = fmt::format("{}, {}", processorName(), counted(threads, "thread"));
}

// Calls visit(offset, normal, number) for the points around a position, as they are at the time of the question in the
// frame of reference of the felt surface.
template <class Visit>
void CpuTouch::forEachNear(const DVec3& x, double radius, Visit&& visit) const {
  const CpuBridge::Points near = pointsNow();
  const auto goesOn = [&](std::size_t more) { return limit_.allows(more); };
  if (!near.frame || age_s_ == 0 || near.frame->velocities.empty()) {
    const auto visitPoint = [&](const SortedGrid::Placed& point) {
      visit(DVec3(point.position) - x, near.normals[point.number], point.number);
    };
    near.grid.forEachNearWhile(x, radius, visitPoint, goesOn);
    return;
  }
  const CloudFrame& frame = *near.frame;
  const double reach = (1 + static_cast<double>(shared::kPatchSlack)) * radius;
  const auto age_s = static_cast<float>(age_s_);
  const auto visitPoint = [&](const SortedGrid::Placed& point) {
    const std::uint32_t i = point.number;
    const DVec3 offset = shared::placeAfter(DVec3(point.position), DVec3(frame.velocities[i]), ofSurface_, age_s_) - x;
    if (!(glm::dot(offset, offset) < radius * radius)) return;
    const Vec3& normal = frame.normals[i];
    visit(offset, frame.turns.empty() ? normal : shared::normalAfter(normal, frame.turns[i], age_s), i);
  };
  near.grid.forEachNearWhile(x, reach, visitPoint, goesOn);
}

CpuBridge::Points CpuTouch::pointsNow() const {
  if (!frames_) return {.grid = sculpture_.grid(), .normals = sculpture_.points().normals, .version = edits_.version()};
  const CloudFrame& frame = frames_->frame();
  return {.grid = frames_->grid(), .normals = frame.normals, .version = frames_->count(), .frame = &frame};
}

CpuBridge CpuTouch::makeBridge() const {
  return {surface_, options_.friction, origin_, 1.0 / static_cast<double>(sculpture_.grid().grid().inverseCell)};
}

SurfaceSample CpuTouch::surface(const DVec3& x, const DVec3& facing) const {
  return surfaceOf(surface_, facing, [&](double radius, auto&& visit) {
    forEachNear(x, radius, [&](const DVec3& offset, const Vec3& normal, std::uint32_t) { visit(offset, normal); });
  });
}

DVec3 CpuTouch::velocity(const DVec3& x, const DVec3& facing) const {
  if (!frames_ || frames_->frame().velocities.empty()) return DVec3(0);
  const CloudFrame& frame = frames_->frame();
  DVec3 sum(0);
  double weights = 0;
  forEachNear(x, surface_.radius, [&](const DVec3& offset, const Vec3& normal, std::uint32_t number) {
    const double r = glm::length(offset) / surface_.radius;
    const double w = wendland(std::min(1.0, r)) * shared::facingWeight(glm::dot(DVec3(normal), facing));
    sum += w * DVec3(frame.velocities[number]);
    weights += w;
  });
  return weights > 0 ? shared::knownVelocity(sum / weights, facing, frame.slides ? 0.0 : 1.0) : DVec3(0);
}

std::span<const Contact> CpuTouch::ask(std::span<const Pose> poses, double budget_us) noexcept {
  PALPATE_CHECK_EQ(poses.size(), hands_.size());
  const auto fail = [&] {
    for (std::size_t i = 0; i < hands_.size(); ++i) hands_[i].probes.fail(poses[i], failure_ != nullptr);
  };
  if (failure_ || !isFiniteAt(poses)) {
    fail();
    return given();
  }
  limit_.begin(budget_us);
  try {
    const bool isEdited = edits_.finishedWithin(limit_.wait_us());
    limit_.beginAnswer();
    if (!isEdited)
      for (std::size_t i = 0; i < hands_.size(); ++i) bridge(hands_[i], poses[i]);
    const bool isBridged = !isEdited || !answer(poses);
    limit_.end();
    if (isBridged) bridged_.note(hands_.front().bridge.isThinned());
    if (isBridged && bridgeTimes_us_.size() < bridgeTimes_us_.capacity())
      bridgeTimes_us_.push_back(limit_.answerTime_us());
  } catch (...) {
    failure_ = std::current_exception();
    fail();
  }
  return given();
}

bool CpuTouch::isFiniteAt(std::span<const Pose> poses) const {
  for (std::size_t i = 0; i < hands_.size(); ++i)
    if (!hands_[i].probes.isFiniteAt(poses[i], origin_)) return false;
  return true;
}

std::span<const Contact> CpuTouch::given() {
  for (std::size_t i = 0; i < hands_.size(); ++i) answers_[i] = hands_[i].probes.answer();
  return answers_;
}

void CpuTouch::endTick() noexcept {
  if (failure_) return;
  try {
    if (edits_.isBegun() && realtime_)
      for (CpuHand& hand : hands_) {
        const Pose& pose = hand.probes.question();
        hand.bridge.renew(pointsNow(), pose);
        hand.bridge.edited(pose.time_s);
      }
    edits_.start();
    if (frames_ && realtime_) frames_->goOn(hands_.front().probes.question().time_s);
  } catch (...) {
    failure_ = std::current_exception();
  }
}

bool CpuTouch::answer(std::span<const Pose> poses) {
  const double now_s = poses.front().time_s;
  realtime_ = limit_.isRealtime();
  if (frames_ && !realtime_) frames_->bring(now_s);
  if (frames_) age_s_ = pointsMotion(now_s, frames_->frame().time(), 0).age_s;
  const bool tries = !realtime_ || attempts_.mayEdit(now_s);
  bool inTime = tries;
  for (std::size_t i = 0; i < hands_.size(); ++i) {
    inTime = inTime && feel(hands_[i], poses[i]);
    if (inTime) continue;
    hands_[i].bridge.renew(pointsNow(), poses[i]);
    bridge(hands_[i], poses[i]);
  }
  if (tries) attempts_.took(now_s, inTime ? 0 : 1e-6 * limit_.answerTime_us());
  sculpt(poses.front());
  return inTime;
}

void CpuTouch::sculpt(const Pose& pose) {
  const Contact& own = hands_.front().probes.own();
  if (own.valid)
    edits_.feel(own, pose);
  else
    edits_.lift();
  // In real time one answer starts one edit: brush and offers alternate, so that neither starves if edits are slow and
  // the others continue.
  const bool brushFirst = realtime_ && own.valid && edits_.lastWasOffer();
  if (brushFirst && edits_.editIfYielding(pose.time_s, realtime_)) return;
  if (edits_.takeUpOffer(pose.time_s, realtime_)) {
    if (realtime_) return;  // the brush continues with the next tick
    edits_.finishedWithin(0);
  }
  if (own.valid && !brushFirst) edits_.editIfYielding(pose.time_s, realtime_);
}

void CpuTouch::resetHand(std::size_t hand) noexcept {
  forget(hands_[hand]);
  hands_[hand].bridge.reset();
  attempts_ = EditPace(0);
  if (hand == 0) edits_.lift();
}

void CpuTouch::forget(CpuHand& hand) {
  for (ProxyTracker& tracker : hand.trackers) tracker.goOnFrom({});
  hand.probes.forget();
}

void CpuTouch::setBrush(const std::optional<BrushOptions>& brush) {
  if (!edits_.hasThread()) throw Error("{}: points can only be changed where they can be edited", report().machine);
  finish();
  edits_.setBrush(brush);
}

void CpuTouch::setContact(SurfaceKind surface, double friction, std::string_view /*method*/) {
  finish();
  surface_.kind = surface;
  options_.friction = friction;
  const std::vector<ProxyTracker::State> states = contacts();
  for (CpuHand& hand : hands_) {
    hand.trackers.assign(hand.trackers.size(), ProxyTracker(options_.radius, friction));
    hand.bridge = makeBridge();
  }
  goOnFrom(states);
}

std::vector<ProxyTracker::State> CpuTouch::contacts() const {
  std::vector<ProxyTracker::State> states;
  for (const CpuHand& hand : hands_) {
    const std::size_t first = states.size();
    for (const ProxyTracker& tracker : hand.trackers) states.push_back(tracker.state());
    if (const auto newer = hand.bridge.newerState()) states[first] = *newer;
  }
  return states;
}

void CpuTouch::restoreContacts(std::span<const ProxyTracker::State> states) {
  requireStates(states.size(), contacts().size());
  goOnFrom(states);
  edits_.restart();
}

void CpuTouch::goOnFrom(std::span<const ProxyTracker::State> states) {
  for (CpuHand& hand : hands_) {
    hand.bridge.answered(hand.probes.own(), hand.probes.ownPose(), states.front());
    for (ProxyTracker& tracker : hand.trackers) {
      tracker.goOnFrom(states.front());
      states = states.subspan(1);
    }
  }
}

Contact CpuTouch::contactOf(ProxyTracker& tracker, const DVec3& hip, double now_s) {
  ofSurface_ = tracker.velocity();
  tracker.follow(*this, hip - origin_, now_s, frames_ ? frames_->frame().time() : PointsTime{.true_s = now_s});
  const SurfaceSample& surface = tracker.surface();
  return {.proxy = tracker.touching() ? tracker.proxy() + origin_ : hip,
          .normal = surface.normal,
          .touching = tracker.touching(),
          .fresh = true,
          .valid = isFinite(tracker.proxy()) && isFinite(surface.normal),
          .isWithin = tracker.isLost(),
          .neighbours = surface.neighbours,
          .velocity = tracker.velocity()};
}

bool CpuTouch::feel(CpuHand& hand, const Pose& pose) {
  if (limit_.isRealtime()) hand.before = hand.trackers;
  if (const auto newer = hand.bridge.newerState()) hand.trackers.front().goOnFrom(*newer);
  hand.probes.ask(pose);
  for (std::uint32_t i = 0; i < hand.probes.probes(); ++i) {
    const Contact contact = contactOf(hand.trackers[i], hand.probes.place(i, pose), pose.time_s);
    if (limit_.isOver()) {
      std::swap(hand.trackers, hand.before);
      return false;
    }
    hand.probes.answered(i, contact);
  }
  hand.bridge.answered(hand.probes.own(), pose, hand.trackers.front().state());
  hand.probes.give();
  return true;
}

void CpuTouch::bridge(CpuHand& hand, const Pose& pose) {
  hand.probes.ask(pose);
  const Contact own = hand.bridge.answer(pose);
  if (!edits_.isUnderWay()) hand.probes.answered(0, own);
  hand.probes.bridge(own, pose, hand.bridge.trust(pose.time_s),
                     [&](std::uint32_t probe, const Pose& at) { return hand.bridge.follow(hand.trackers[probe], at); });
}

void CpuTouch::change(std::span<const PointChange> changes) {
  finish();
  edits_.change(changes, hands_.front().probes.ownPose().time_s);
}

void CpuTouch::lock(const PointLock& lock) {
  finish();
  edits_.lock(lock);
}

bool CpuTouch::replace(const PointSet& changed, std::span<const PointState> states, const PointSet& without) {
  finish();
  edits_.replace(changed, states, without);
  return true;
}

void CpuTouch::finish() {
  if (failure_) std::rethrow_exception(failure_);
  edits_.finish();
  if (frames_) frames_->finish();
  attempts_ = EditPace(0);
}

std::size_t CpuTouch::readBack(PointCloud& cloud) const {
  if (frames_) return placeAt(frames_->frame(), cloud);
  edits_.wait();
  std::vector<PointState> points(sculpture_.points().size());
  for (std::uint32_t i = 0; i < points.size(); ++i) points[i] = sculpture_.points().state(i);
  const std::size_t changed = changedPoints(cloud, points);
  cloud = editedCloud(cloud, points);
  return changed;
}

EditScope CpuTouch::scope() const {
  if (!options_.source) return {};
  return {.paints = false,
          .newPoints = static_cast<std::uint32_t>(options_.source->size() - sculpture_.points().size())};
}

BackendReport CpuTouch::report() const {
  const TouchStatistics& edits = edits_.statistics();
  const IndexWork& index = edits_.collected().index;
  TouchShortfalls shortfalls = edits.shortfalls;
  for (const CpuHand& hand : hands_) shortfalls.thinnedPatches += hand.bridge.thinnedPatches();
  return {.machine = machine_,
          .cell = 1.0 / static_cast<double>(sculpture_.grid().grid().inverseCell),
          .scope = scope(),
          .build_us = sculpture_.buildTime_us(),
          .editTimes_us = edits.editTimes_us,
          .firstEdit_s = edits.firstEditTime_s,
          .costs = {.requests_us = {}, .states = edits_.answered(), .lastTouched = edits_.collected().touched},
          .bridgeTimes_us = bridgeTimes_us_,
          .shortfalls = shortfalls,
          .index = {.followed = index.followed, .built = index.built + (frames_ ? frames_->count() : 0)},
          .memory = edits_.collected().memory};
}

}  // namespace palpate
