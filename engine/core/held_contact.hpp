#pragma once

#include <algorithm>

#include "engine/core/contact_query.hpp"

namespace palpate {

/// Up to the first age the tangent plane of an answer is used at full stiffness; after the second it says nothing about
/// the surface.
constexpr double kStale_s = 0.005, kStalest_s = 0.02;

/// Share of a force at an age: one up to `from_s`, then falling linearly to zero at `to_s`.
inline double shareLeft(double age_s, double from_s, double to_s) {
  return std::clamp((to_s - age_s) / (to_s - from_s), 0.0, 1.0);
}

/// The contact with a share of its spring from the HIP to the proxy; with a share of zero it touches nothing.
inline Contact softened(Contact contact, const Pose& pose, double share) {
  if (!contact.touching || share >= 1) return contact;
  contact.touching = share > 0;
  contact.proxy = share > 0 ? glm::mix(pose.hip, contact.proxy, share) : pose.hip;
  return contact;
}

/// Time of the data of an answer, s; negative: unknown. An answer that was held itself has the time of its own data.
inline double dataTime_s(const Contact& answer, const Pose& pose) {
  if (!answer.valid) return -1;
  return answer.fresh || answer.dataTime_s < 0 ? pose.time_s : answer.dataTime_s;
}

/// Answer to a pose without an answer of its own, from the last answer: the tangent plane at the last proxy. Not fresh.
inline Contact heldPlane(const Contact& last, const Pose& lastPose, const Pose& pose) {
  const double data_s = dataTime_s(last, lastPose);
  const Contact free{.proxy = pose.hip, .valid = true, .dataTime_s = data_s};
  if (!last.valid || !last.touching) return free;
  const DVec3 proxy = last.proxy + (pose.time_s - lastPose.time_s) * last.velocity;  // the plane keeps its velocity
  const double depth = glm::dot(proxy - pose.hip, last.normal);
  if (depth <= 0) return free;
  return {.proxy = pose.hip + depth * last.normal,
          .normal = last.normal,
          .touching = true,
          .valid = true,
          .neighbours = last.neighbours,
          .velocity = last.velocity,
          .dataTime_s = data_s};
}

/// That plane with a share of its stiffness; with a share of zero nothing is there.
inline Contact heldPlane(const Contact& last, const Pose& lastPose, const Pose& pose, double share) {
  const Contact contact = softened(heldPlane(last, lastPose, pose), pose, share);
  if (contact.touching) return contact;
  return {.proxy = pose.hip, .valid = true, .dataTime_s = contact.dataTime_s};
}

/// The same, softened by its age.
inline Contact heldContact(const Contact& last, const Pose& lastPose, const Pose& pose) {
  return heldPlane(last, lastPose, pose, shareLeft(pose.time_s - lastPose.time_s, kStale_s, kStalest_s));
}

/// The answer to a hand with these points of a tool (ContactQuery::points()): `whole` is the answer to its HIP.
Contact combined(Contact whole, std::span<const PointContact> points, const DVec3& hip);

}  // namespace palpate
