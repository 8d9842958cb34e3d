#include "engine/touch/cpu_touch.hpp"

#include <algorithm>
#include <utility>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/core/check.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/error.hpp"
#include "engine/core/held_contact.hpp"
#include "engine/core/processor.hpp"
#include "engine/core/thread_priority.hpp"
#include "shaders/shared/edit.h"

namespace palpate {

namespace {

HashGrid gridFor(const PointCloud& cloud, const CpuTouchOptions& options) {
  return makeHashGrid(Vec3(boundsOf(cloud).min), options.cell > 0 ? options.cell : options.radius, cloud.size(),
                      options.bucketKey);
}

SculptOptions sculptOptions(const CpuTouchOptions& options) {
  return {.radius = options.radius / options.widening,
          .keepsDensity = options.brush && options.brush->keepsDensity,
          .threads = options.threads};
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
      tracker_(options.radius, options.friction),
      secondTracker_(tracker_),
      pace_(kStalest_s) {
  if (!options.tool.points.empty()) toolContacts_.emplace(options.tool);
  toolTrackers_.assign(options.tool.points.size(), tracker_);
  if (!options.brush) return;
  editTimes_us_.reserve(kEditTimesKept);
  edit_ = std::make_unique<BackgroundTask>([this] {
    giveWay();  // to the thread that answers
    edit();
  });
}

SurfaceSample CpuTouch::surface(const DVec3& x, const DVec3& facing) const {
  return surfaceOf(surface_, facing, [&](double radius, auto&& visit) {
    sculpture_.grid().forEachNear(x, radius, [&](const SortedGrid::Placed& point) {
      visit(DVec3(point.position) - x, sculpture_.points().normals[point.number]);
    });
  });
}

Contact CpuTouch::query(const Pose& pose, double budget_us) noexcept {
  Contact invalid{.proxy = pose.hip, .lost = failure_ != nullptr};
  second_.ask(pose);
  if (failure_ || !isFinite(Vec3(pose.hip - origin_)) || !isFinite(Vec3(SecondContact::placeOf(pose) - origin_)) ||
      (toolContacts_ && !toolContacts_->isFiniteAt(pose, origin_)))
    return invalid;
  try {
    if (!editFinishedWithin(budget_us)) return held(pose);
    const DVec3 lastHip = last_.valid ? lastPose_.hip : pose.hip;
    answer(pose);
    if ((!last_.touching || !last_.valid || !pose.sculpts) && sculpture_.settled()) endStroke();
    if (last_.valid) editIfYielding(lastHip, budget_us > 0);
    return told();
  } catch (...) {
    failure_ = std::current_exception();
    invalid.lost = true;
    return invalid;
  }
}

std::span<const PointContact> CpuTouch::points() const noexcept {
  return toolContacts_ ? toolContacts_->points() : std::span<const PointContact>();
}

Contact CpuTouch::told() { return toolContacts_ ? toolContacts_->whole() : last_; }

Contact CpuTouch::held(const Pose& pose) {
  second_.hold(pose);
  return toolContacts_ ? toolContacts_->held(pose) : heldContact(last_, lastPose_, pose);
}

void CpuTouch::beginAnew() noexcept { forget(); }

void CpuTouch::secondBeginsAnew() noexcept {
  secondTracker_.goOnFrom({});
  second_.forget();
}

void CpuTouch::forget() {
  tracker_.goOnFrom({});
  for (ProxyTracker& tracker : toolTrackers_) tracker.goOnFrom({});
  if (toolContacts_) toolContacts_->forget();
  last_ = {};
}

void CpuTouch::setBrush(const std::optional<BrushOptions>& brush) {
  if (!edit_) throw Error("{}: points can only be changed where they can be edited", machine());
  finish();
  brushOn_ = brush.has_value();
  if (brush) options_.brush = brush;
}

void CpuTouch::setContact(SurfaceKind surface, double friction) {
  finish();
  surface_.kind = surface;
  tracker_ = ProxyTracker(options_.radius, friction);
  toolTrackers_.assign(toolTrackers_.size(), tracker_);
  secondTracker_ = tracker_;
  forget();
  secondBeginsAnew();
}

Contact CpuTouch::contactOf(ProxyTracker& tracker, const DVec3& hip) const {
  tracker.follow(*this, hip - origin_);
  const SurfaceSample& surface = tracker.surface();
  return {.proxy = tracker.touching() ? tracker.proxy() + origin_ : hip,
          .normal = surface.normal,
          .touching = tracker.touching(),
          .fresh = true,
          .valid = isFinite(tracker.proxy()) && isFinite(surface.normal),
          .neighbours = surface.neighbours};
}

void CpuTouch::answer(const Pose& pose) {
  last_ = contactOf(tracker_, pose.hip);
  lastPose_ = pose;
  if (toolContacts_) toolContacts_->answered(last_, pose);
  for (std::uint32_t i = 0; toolContacts_ && i < toolContacts_->size(); ++i)
    toolContacts_->answered(i, contactOf(toolTrackers_[i], toolContacts_->hip(i, pose)));
  if (pose.secondHip) second_.answered(contactOf(secondTracker_, *pose.secondHip), pose);
}

void CpuTouch::editIfYielding(const DVec3& lastHip, bool realtime) {
  if (!edit_ || !brushOn_ || (last_.touching && !lastPose_.sculpts)) return;
  const DVec3 spring = last_.touching ? last_.proxy - lastPose_.hip : DVec3(0);
  tool_.emplace(*options_.brush, options_.radius / options_.widening, lastPose_.hip - origin_, lastHip - origin_,
                spring);
  if (!tool_->acts() && sculpture_.settled()) return;
  if (realtime && !pace_.mayEdit(lastPose_.time_s)) {
    ++shortfalls_.editsTooSlow;
    return;
  }
  if (!firstEditTime_s_) firstEditTime_s_ = lastPose_.time_s;
  editTime_s_ = lastPose_.time_s;
  editing_ = inStroke_ = true;
  edit_->start();
}

void CpuTouch::edit() {
  const Stopwatch watch;
  sculpture_.edit(*tool_);
  const auto changed = sculpture_.changed();
  queue_.append(changed.size(), [&](std::size_t i) { return sculpture_.points().state(changed[i]); });
  editsTold_ += changed.size();
  editTime_us_ = watch.elapsed_us();
}

bool CpuTouch::editFinishedWithin(double budget_us) {
  if (!editing_) return true;
  if (!edit_->finishedWithin(budget_us)) return false;
  editing_ = false;
  editsAnswered_ = editsTold_;
  pace_.took(editTime_s_, editTime_us_ * 1e-6);
  if (editTimes_us_.size() < editTimes_us_.capacity()) editTimes_us_.push_back(editTime_us_);
  return true;
}

void CpuTouch::endStroke() {
  if (std::exchange(inStroke_, false)) queue_.endStroke();
}

void CpuTouch::change(std::span<const PointChange> changes) {
  finish();
  if (changes.empty()) return;
  sculpture_.set(changes);
  queue_.append(
      changes.size(), [&](std::size_t i) { return changes[i].to; }, EditMark::Kind::change);
  editsAnswered_ = editsTold_ += changes.size();
  if (!firstEditTime_s_) firstEditTime_s_ = lastPose_.time_s;
}

void CpuTouch::finish() {
  if (failure_) std::rethrow_exception(failure_);
  editFinishedWithin(0);
  endStroke();
}

std::size_t CpuTouch::readBack(PointCloud& cloud) const {
  if (edit_) edit_->finishedWithin(0);
  std::vector<PointState> points(sculpture_.points().size());
  for (std::uint32_t i = 0; i < points.size(); ++i) points[i] = sculpture_.points().state(i);
  const std::size_t changed = changedPoints(cloud, points);
  cloud = editedCloud(cloud, points);
  return changed;
}

std::string CpuTouch::machine() const {
  const std::size_t threads = sculpture_.threads();
  return fmt::format("{}, {} thread{}", processorName(), threads, threads == 1 ? "" : "s");
}

}  // namespace palpate
