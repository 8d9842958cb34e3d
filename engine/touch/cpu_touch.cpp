#include "engine/touch/cpu_touch.hpp"

#include <algorithm>
#include <utility>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/core/check.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/held_contact.hpp"
#include "engine/core/processor.hpp"
#include "shaders/shared/edit.h"

namespace palpate {

namespace {

constexpr std::size_t kRefitBatch = 64;  // points that a thread takes at a time

HashGrid gridFor(const PointCloud& cloud, const CpuTouchOptions& options) {
  return makeHashGrid(Vec3(boundsOf(cloud).min), options.cell > 0 ? options.cell : options.radius, cloud.size(),
                      options.bucketKey);
}

}  // namespace

CpuTouch::CpuTouch(const PointCloud& cloud, const CpuTouchOptions& options)
    : options_(options),
      origin_(cloud.origin),
      positions_(cloud.positions),
      normals_(cloud.normals),
      colors_(cloud.size()),
      parents_(cloud.size()),
      there_(cloud.size(), 1),
      grid_(gridFor(cloud, options), options.threads),
      surface_{.radius = options.radius, .kind = options.surface, .localRadius = options.localRadius},
      tracker_(options.radius, options.friction),
      pace_(kStalest_s) {
  PALPATE_CHECK_EQ(normals_.size(), positions_.size());
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    colors_[i] = packedColor(cloud, i);
    parents_[i] = i;
  }
  const Stopwatch watch;
  grid_.build(positions_, there_);
  buildTime_us_ = watch.elapsed_us();
  if (!options.brush) return;
  moved_.reserve(positions_.size());
  editTimes_us_.reserve(kEditTimesKept);
  edit_ = std::make_unique<BackgroundTask>([this] { edit(); });
}

SurfaceSample CpuTouch::surface(const DVec3& x, const DVec3& facing) const {
  return surfaceOf(surface_, facing, [&](double radius, auto&& visit) {
    grid_.forEachNear(
        x, radius, [&](const SortedGrid::Placed& point) { visit(DVec3(point.position) - x, normals_[point.number]); });
  });
}

Contact CpuTouch::query(const Pose& pose, double budget_us) noexcept {
  const Contact invalid{.proxy = pose.hip};
  if (failure_ || !isFinite(Vec3(pose.hip - origin_))) return invalid;
  try {
    if (!editFinishedWithin(budget_us)) return heldContact(last_, lastPose_, pose);
    answer(pose);
    if (!last_.touching || !last_.valid) endStroke();
    if (last_.valid) editIfYielding(budget_us > 0);
    return last_;
  } catch (...) {
    failure_ = std::current_exception();
    return invalid;
  }
}

void CpuTouch::answer(const Pose& pose) {
  tracker_.follow(*this, pose.hip - origin_);
  const SurfaceSample& surface = tracker_.surface();
  last_ = {.proxy = tracker_.touching() ? tracker_.proxy() + origin_ : pose.hip,
           .normal = surface.normal,
           .touching = tracker_.touching(),
           .fresh = true,
           .valid = isFinite(tracker_.proxy()) && isFinite(surface.normal),
           .neighbours = surface.neighbours};
  lastPose_ = pose;
}

void CpuTouch::editIfYielding(bool realtime) {
  if (!edit_ || !last_.touching) return;
  const DVec3 hip = lastPose_.hip - origin_;
  tool_.emplace(*options_.brush, options_.radius, hip, hip, last_.proxy - lastPose_.hip);
  if (!tool_->acts()) return;
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
  moved_.clear();
  grid_.forEachNear(tool_->center(), tool_->radius(),
                    [&](const SortedGrid::Placed& point) { moved_.push_back(point.number); });
  for (const std::uint32_t point : moved_)
    positions_[point] = Vec3(tool_->brushed(DVec3(positions_[point]), DVec3(normals_[point])).position);
  grid_.build(positions_, there_);
  const std::size_t batches = (moved_.size() + kRefitBatch - 1) / kRefitBatch;
  grid_.team().forEach(batches, [&](std::size_t batch) {
    const std::size_t end = std::min(moved_.size(), (batch + 1) * kRefitBatch);
    for (std::size_t i = batch * kRefitBatch; i < end; ++i) refit(moved_[i]);
  });
  tellOfEdit();
  editTime_us_ = watch.elapsed_us();
}

void CpuTouch::tellOfEdit() {
  queue_.append(moved_.size(), [&](std::size_t i) { return state(moved_[i]); });
  editsTold_ += moved_.size();
}

void CpuTouch::refit(std::uint32_t point) {
  const DVec3 place(positions_[point]);
  NormalFit fit(options_.radius);
  grid_.forEachNear(place, options_.radius,
                    [&](const SortedGrid::Placed& near) { fit.add(DVec3(near.position) - place); });
  normals_[point] = Vec3(fit.normal(DVec3(normals_[point])).normal);
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
  for (const PointChange& change : changes) set(change.to);
  grid_.build(positions_, there_);
  queue_.append(
      changes.size(), [&](std::size_t i) { return changes[i].to; }, EditMark::Kind::change);
  editsAnswered_ = editsTold_ += changes.size();
  if (!firstEditTime_s_) firstEditTime_s_ = lastPose_.time_s;
}

PointState CpuTouch::state(std::uint32_t point) const {
  return {.position = positions_[point],
          .id = there_[point] ? point : point | PointState::kGone,
          .normal = normals_[point],
          .color = colors_[point],
          .parent = parents_[point]};
}

void CpuTouch::set(const PointState& state) {
  const std::uint32_t point = state.number();
  while (positions_.size() <= point) {
    parents_.push_back(static_cast<std::uint32_t>(positions_.size()));
    positions_.emplace_back(0);
    normals_.emplace_back(0);
    colors_.push_back(0);
    there_.push_back(0);
  }
  positions_[point] = state.position;
  normals_[point] = state.normal;
  colors_[point] = state.color;
  parents_[point] = state.parent;
  there_[point] = !state.gone();
}

void CpuTouch::finish() {
  if (failure_) std::rethrow_exception(failure_);
  editFinishedWithin(0);
  endStroke();
}

std::size_t CpuTouch::readBack(PointCloud& cloud) const {
  if (edit_) edit_->finishedWithin(0);
  std::vector<PointState> points(positions_.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) points[i] = state(i);
  const std::size_t changed = changedPoints(cloud, points);
  cloud = editedCloud(cloud, points);
  return changed;
}

std::string CpuTouch::machine() const {
  const std::size_t threads = grid_.threads();
  return fmt::format("{}, {} thread{}", processorName(), threads, threads == 1 ? "" : "s");
}

}  // namespace palpate
