#pragma once

#include <algorithm>

#include "engine/core/contact_query.hpp"

namespace palpate {

/// An answer is good for the first time without loss, and says nothing about where the hand is after the second.
constexpr double kStale_s = 0.005, kStalest_s = 0.02;

/// What the last answer says to a pose that got none of its own: the tangent plane at the last proxy, in full at first,
/// then ever softer, and past kStalest_s not at all. Not fresh.
inline Contact heldContact(const Contact& last, const Pose& lastPose, const Pose& pose) {
  Contact contact{.proxy = pose.hip, .valid = true};
  if (last.valid) contact.dataTime_s = lastPose.time_s;
  const double age_s = pose.time_s - lastPose.time_s;
  if (!last.valid || !last.touching || age_s > kStalest_s) return contact;
  const double depth = glm::dot(last.proxy - pose.hip, last.normal);
  if (depth <= 0) return contact;
  const double softness = std::clamp((kStalest_s - age_s) / (kStalest_s - kStale_s), 0.0, 1.0);
  contact.touching = true;
  contact.proxy = pose.hip + softness * depth * last.normal;
  contact.normal = last.normal;
  contact.neighbours = last.neighbours;
  return contact;
}

}  // namespace palpate
