#include "engine/touch/patch_bridge.hpp"

#include <utility>

#include "engine/core/clock.hpp"
#include "engine/gpu/device.hpp"

namespace palpate {

namespace {

constexpr double kRenewal = 0.5;  // in support radii: distance from its centre at which a patch is refetched
constexpr std::size_t kAnswerTimesKept = 1 << 16;

}  // namespace

PatchBridge::PatchBridge(Device& device, const HashGrid& grid, const DVec3& origin, const SurfaceOptions& surface,
                         double friction, std::uint32_t points, const PatchFetch::Motion& motion)
    : device_(device),
      radius_(surface.radius),
      origin_(origin),
      pointsMove_(motion.pointsMove),
      pass_(device, grid, surface.radius, points, motion),
      contact_(surface, friction, origin) {
  answerTimes_us_.reserve(kAnswerTimesKept);
}

void PatchBridge::record(std::uint32_t parity, const shared::CloudView& cloud, DeviceAddress velocities) {
  auto& list = lists_[parity];
  list = std::make_unique<CommandList>(device_, device_.latencyQueue(), "fetch patch");
  list->begin();
  pass_.record(*list, cloud, velocities);
  list->end();
}

void PatchBridge::renew(const Pose& pose, std::uint32_t parity, const PointsTime& points) {
  takeIn();
  const ProxyTracker::State state = contact_.state();
  const DVec3 place = state.touching ? state.proxy : pose.hip - origin_;
  if (underWay_ || !wanted(place)) return;
  // Moving points are fetched at their present positions, and move on from there.
  const double age_s = pointsMove_ ? pointsMotion(pose.time_s, points, pose.time_s).age_s : 0;
  pass_.aimAt(Vec3(place - age_s * state.velocity), age_s, Vec3(place));
  const PointsTime from{.true_s = points.true_s + age_s, .extrapolationLimit_s = points.extrapolationLimit_s - age_s};
  underWay_ = Fetch{device_.latencyQueue().submit(*lists_[parity]), pose.time_s, edits_, from};
}

bool PatchBridge::wanted(const DVec3& place) const {
  return !taken_ || taken_->edits != edits_ || glm::distance(place, contact_.centre()) > kRenewal * radius_;
}

void PatchBridge::takeIn() {
  if (!underWay_ || !device_.latencyQueue().isDone(underWay_->ticket)) return;
  taken_ = std::exchange(underWay_, std::nullopt);
  const CarriedPatch patch = pass_.patch();
  // The first edit that it does not include came after it was requested.
  contact_.take(patch, taken_->edits == edits_ ? std::nullopt : std::optional(taken_->time_s), taken_->points);
  thinnedPatches_ += patch.thinned;
}

void PatchBridge::edited(double time_s) {
  ++edits_;
  contact_.edited(time_s);
}

void PatchBridge::answered(const Contact& contact, const Pose& pose, const ProxyTracker::State& state, double now_s) {
  contact_.heard(now_s);
  // If the CPU has continued since the question, a late answer is outdated.
  if (!contact_.isAhead()) contact_.goOnFrom(contact, pose, state);
}

std::optional<ProxyTracker::State> PatchBridge::newerState() const {
  return contact_.isAhead() ? std::optional(contact_.state()) : std::nullopt;
}

Contact PatchBridge::answer(const Pose& pose) {
  const Stopwatch watch;
  takeIn();
  const Contact contact = contact_.answer(pose);
  if (answerTimes_us_.size() < answerTimes_us_.capacity()) answerTimes_us_.push_back(watch.elapsed_us());
  return contact;
}

}  // namespace palpate
