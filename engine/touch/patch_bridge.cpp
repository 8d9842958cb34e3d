#include "engine/touch/patch_bridge.hpp"

#include <algorithm>
#include <utility>

#include "engine/contact/gather.hpp"
#include "engine/core/clock.hpp"
#include "engine/gpu/device.hpp"
#include "shaders/compiled.hpp"

namespace palpate {

namespace {

constexpr std::uint32_t kMaxCells =
    shared::kCarriedCellsPerSide * shared::kCarriedCellsPerSide * shared::kCarriedCellsPerSide;

// The loops of one invocation: every round of cells with its candidates, each with a scan over up to 32 subgroups.
static_assert(kMaxCells / shared::kContactWorkgroup * (shared::kPatchRoundCandidates / shared::kContactWorkgroup + 1) *
                  (1 + 32) <
              60'000);

constexpr double kRenewal = 0.5;  // in support radii: distance from its centre at which a patch is refetched
constexpr std::size_t kAnswerTimesKept = 1 << 16;

}  // namespace

PatchFetch::PatchFetch(Device& device, const HashGrid& grid, double radius, std::uint32_t points, const Motion& motion)
    : reach_(std::min(static_cast<double>(shared::kCarriedReach) * radius,
                      widestReach(grid, shared::kCarriedCellsPerSide))),
      pass_(device, shader_code::contact_fetch_patch,
            {.workgroupSize = shared::kContactWorkgroup,
             .pushBytes = sizeof(shared::PatchFetchArgs),
             .constants = {motion.pointsMove ? VK_TRUE : VK_FALSE, motion.normalsTurn ? VK_TRUE : VK_FALSE}}),
      centre_(Buffer::of<Vec4>(device, 1, Memory::upload, "patch centre")),
      patch_(device, sizeof(shared::CarriedHead) + 2 * sizeof(Vec4) * shared::kMaxCarriedPoints, Memory::readback,
             "carried patch"),
      near_(Buffer::of<std::uint32_t>(device, std::min(points, gatherRounds(kMaxCells) * shared::kPatchRoundCandidates),
                                      Memory::device, "points near the patch")) {
  patch_.mapped<shared::CarriedHead>()[0] = {};
}

void PatchFetch::record(CommandList& commands, const shared::CloudView& cloud, DeviceAddress velocities) const {
  commands.dispatch(pass_, shared::kContactWorkgroup,
                    shared::PatchFetchArgs{.cloud = cloud,
                                           .centre = centre_.address(),
                                           .fetched = patch_.address(),
                                           .near = near_.address(),
                                           .velocities = velocities,
                                           .reach = static_cast<float>(reach_),
                                           .mostCells = kMaxCells});
}

void PatchFetch::aimAt(const Vec3& centre, double age_s, const Vec3& now) {
  aim_ = now;
  centre_.mapped<Vec4>()[0] = Vec4(centre, static_cast<float>(age_s));
}

CarriedPatch PatchFetch::patch() const {
  const shared::CarriedHead& head = patch_.mapped<const shared::CarriedHead>()[0];
  constexpr std::size_t kHead = sizeof(shared::CarriedHead) / sizeof(Vec4);
  const std::size_t count = std::min(head.count, shared::kMaxCarriedPoints);
  return {.centre = aim_,
          .reach = reach_,
          .points = patch_.mapped<const Vec4>().subspan(kHead, 2 * count),
          .thinned = head.thinned != 0};
}

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
