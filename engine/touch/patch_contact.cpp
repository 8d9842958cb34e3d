#include "engine/touch/patch_contact.hpp"

#include <algorithm>

#include "engine/contact/carried_patch.hpp"
#include "engine/core/held_contact.hpp"
#include "shaders/shared/contact.h"

namespace palpate {

PatchContact::PatchContact(const SurfaceOptions& surface, double friction, const DVec3& origin)
    : surface_(surface), radius_(surface.radius), origin_(origin), tracker_(surface.radius, friction) {
  points_.reserve(shared::kMaxCarriedPoints);
  near_.reserve(shared::kMaxCarriedPoints);
}

void PatchContact::take(const CarriedPatch& patch, std::optional<double> missingSince_s, const PointsTime& time) {
  const std::size_t count = std::min<std::size_t>(patch.points.size() / 2, shared::kMaxCarriedPoints);
  points_.clear();
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 position(patch.points[2 * i]), normal(patch.points[2 * i + 1]);
    if (isFinite(position) && isFinite(normal)) points_.push_back({DVec3(position), normal});
  }
  centre_ = DVec3(patch.centre);
  reach_ = patch.reach;
  thinned_ = patch.thinned;
  missingSince_s_ = missingSince_s;
  time_ = time;
  gathered_ = false;
}

void PatchContact::edited(double time_s) {
  if (!missingSince_s_) missingSince_s_ = time_s;
}

void PatchContact::goOnFrom(const Contact& contact, const Pose& pose, const ProxyTracker::State& state) {
  last_ = contact;
  lastPose_ = pose;
  ahead_ = false;
  if (contact.valid) tracker_.goOnFrom(state);
}

std::optional<Contact> PatchContact::follow(ProxyTracker& tracker, const Pose& pose) const noexcept {
  const ProxyTracker::State before = tracker.state();
  crossedBorder_ = false;
  tracker.follow(*this, pose.hip - origin_, pose.time_s, time_);
  const SurfaceSample& surface = tracker.surface();
  if (crossedBorder_ || !isFinite(tracker.proxy()) || !isFinite(surface.normal)) {
    tracker.goOnFrom(before);
    return std::nullopt;
  }
  return Contact{.proxy = tracker.touching() ? tracker.proxy() + origin_ : pose.hip,
                 .normal = surface.normal,
                 .touching = tracker.touching(),
                 .valid = true,
                 .isWithin = tracker.isLost(),
                 .neighbours = surface.neighbours,
                 .velocity = tracker.velocity(),
                 .dataTime_s = missingSince_s_.value_or(pose.time_s)};  // points at rest are up to date
}

Contact PatchContact::answer(const Pose& pose) noexcept {
  if (!isFinite(pose.hip)) return {.proxy = pose.hip};
  const std::optional<Contact> contact = follow(tracker_, pose);
  if (!contact) return softened(heldContact(last_, lastPose_, pose), pose, trust(pose.time_s));
  ahead_ = true;
  last_ = *contact;
  lastPose_ = pose;
  return softened(last_, pose, trust(pose.time_s));
}

double PatchContact::trust(double time_s) const {
  const double edits = missingSince_s_ ? shareLeft(time_s - *missingSince_s_, kOutdated_s, kMaxOutdated_s) : 1;
  return std::min(edits, shareLeft(time_s - heard_s_, kSilent_s, kMaxSilent_s));
}

SurfaceSample PatchContact::surface(const DVec3& x, const DVec3& facing) const {
  if (needsMore(x)) {
    crossedBorder_ = true;
    return {};
  }
  if (!gathered_ || glm::distance(x, nearCentre_) > static_cast<double>(shared::kPatchSlack) * radius_) gatherAround(x);
  return surfaceOf(surface_, facing, [&](double radius, auto&& visit) {
    for (const Point& point : near_) {
      const DVec3 offset = point.position - x;
      if (glm::dot(offset, offset) < radius * radius) visit(offset, point.normal);
    }
  });
}

void PatchContact::gatherAround(const DVec3& x) const {
  const double reach = (1.0 + static_cast<double>(shared::kPatchSlack)) * radius_;
  near_.clear();
  for (const Point& point : points_) {
    const DVec3 offset = point.position - x;
    if (glm::dot(offset, offset) < reach * reach) near_.push_back(point);
  }
  nearCentre_ = x;
  gathered_ = true;
}

}  // namespace palpate
