#include "engine/touch/tool_contacts.hpp"

#include <algorithm>

#include "engine/core/error.hpp"
#include "engine/core/held_contact.hpp"

namespace palpate {

namespace {

constexpr double kRounding = 1e-9;

}  // namespace

ToolContacts::ToolContacts(const ToolShape& shape) {
  double shares = 0;
  for (const ToolPoint& point : shape.points) {
    places_.push_back(point.place);
    points_.push_back({.share = point.share});
    shares += point.share;
  }
  if (points_.empty() || points_.size() > kMostToolPoints)
    throw UsageError("a tool of {} points: it has 1 to {}", points_.size(), kMostToolPoints);
  if (!(std::abs(shares - 1) < kRounding))
    throw UsageError("a tool whose points have {} of its stiffness; together they must have all of it, 1", shares);
  last_ = points_;
  times_s_.resize(points_.size());
}

bool ToolContacts::isFiniteAt(const Pose& pose, const DVec3& origin) const {
  if (!isTurn(pose.turn)) return false;
  for (std::uint32_t i = 0; i < size(); ++i)
    if (!isFinite(Vec3(hip(i, pose) - origin))) return false;
  return true;
}

void ToolContacts::answered(const Contact& own, const Pose& pose) {
  lastOwn_ = own;
  lastPose_ = pose;
}

void ToolContacts::answered(std::uint32_t i, const Contact& contact) {
  last_[i].hip = hip(i, lastPose_);
  last_[i].contact = contact;
  times_s_[i] = lastPose_.time_s;
}

Contact ToolContacts::whole() {
  points_ = last_;
  return sum(lastOwn_, lastPose_.hip);
}

Contact ToolContacts::heldPoint(std::uint32_t i, const Pose& at) const {
  return heldContact(last_[i].contact, {.time_s = times_s_[i], .hip = last_[i].hip}, at);
}

Contact ToolContacts::held(const Pose& pose) {
  return bridged(heldContact(lastOwn_, lastPose_, pose), pose, 1,
                 [](std::uint32_t, const Pose&) { return std::optional<Contact>(); });
}

Contact ToolContacts::sum(Contact whole, const DVec3& hip) const {
  DVec3 spring(0), normals(0), first(0);
  whole.touching = false;
  for (const PointContact& point : points_) {
    const Contact& contact = point.contact;
    whole.valid = whole.valid && contact.valid;
    whole.fresh = whole.fresh && contact.fresh;
    whole.neighbours = std::max(whole.neighbours, contact.neighbours);
    if (!contact.touching) continue;
    if (!whole.touching) first = contact.normal;
    whole.touching = true;
    if (!contact.fresh) whole.dataTime_s = std::min(whole.dataTime_s, contact.dataTime_s);  // the oldest counts
    const DVec3 way = point.share * (contact.proxy - point.hip);
    spring += way;
    normals += glm::length(way) * contact.normal;
  }
  whole.proxy = hip + spring;
  // Points that have only just come to the surface, or that are pressed from all sides, have no mean.
  const double length = glm::length(normals);
  if (whole.touching) whole.normal = length > 0 ? normals / length : first;
  return whole;
}

void ToolContacts::forget() {
  for (std::vector<PointContact>* points : {&points_, &last_})
    for (PointContact& point : *points) point.contact.touching = false;
  lastOwn_.touching = false;
}

}  // namespace palpate
