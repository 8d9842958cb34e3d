#include "engine/touch/cpu_bridge.hpp"

#include <algorithm>

#include "engine/contact/carried_patch.hpp"
#include "shaders/shared/motion.h"

namespace palpate {

namespace {

constexpr double kRenewal = 0.5;  // in support radii: distance from its centre at which a patch is taken again
constexpr double kMaxReach_cells = shared::kCarriedCellsPerSide / 2.0 - 1;

}  // namespace

CpuBridge::CpuBridge(const SurfaceOptions& surface, double friction, const DVec3& origin, double cell)
    : origin_(origin),
      radius_(surface.radius),
      reach_(std::min(static_cast<double>(shared::kCarriedReach) * surface.radius, kMaxReach_cells * cell)),
      contact_(surface, friction, origin) {
  patch_.reserve(2 * std::size_t{shared::kMaxCarriedPoints});
}

void CpuBridge::renew(const Points& points, const Pose& pose) {
  contact_.heard(pose.time_s);
  const ProxyTracker::State state = contact_.state();
  const DVec3 place = state.touching ? state.proxy : pose.hip - origin_;
  if (taken_ == points.version && glm::distance(place, contact_.centre()) <= kRenewal * radius_) return;
  // Moving points are taken at their present positions, and move on from there.
  const CloudFrame* const frame = points.frame;
  const PointsTime time = frame ? frame->time() : PointsTime{.true_s = pose.time_s};
  const bool moves = frame && !frame->velocities.empty();
  const double age_s = moves ? pointsMotion(pose.time_s, time, pose.time_s).age_s : 0;
  patch_.clear();
  const std::size_t step = points.grid.sampleNear(
      place - age_s * state.velocity, reach_, shared::kMaxCarriedPoints, [&](const SortedGrid::Placed& point) {
        Vec3 position = point.position, normal = points.normals[point.number];
        if (moves)
          position = shared::placeAfter(position, frame->velocities[point.number], Vec3(0), static_cast<float>(age_s));
        if (moves && !frame->turns.empty())
          normal = shared::normalAfter(normal, frame->turns[point.number], static_cast<float>(age_s));
        patch_.emplace_back(position, 0);
        patch_.emplace_back(normal, 0);
      });
  contact_.take({.centre = Vec3(place), .reach = reach_, .points = patch_, .thinned = step > 1}, std::nullopt,
                {.true_s = time.true_s + age_s, .extrapolationLimit_s = time.extrapolationLimit_s - age_s});
  taken_ = points.version;
  thinnedPatches_ += step > 1;
}

}  // namespace palpate
