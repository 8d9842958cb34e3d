#include "engine/touch/probe_group.hpp"

#include "engine/core/error.hpp"

namespace palpate {

namespace {

constexpr double kRounding = 1e-9;

}  // namespace

ProbeGroup::ProbeGroup(const ToolShape& shape) {
  if (shape.points.empty()) return;
  double shares = 0;
  for (const ToolPoint& point : shape.points) {
    places_.push_back(point.place);
    points_.push_back({.share = point.share});
    shares += point.share;
  }
  if (points_.size() > kMaxToolPoints)
    throw UsageError("a tool of {} points: it has 1 to {}", points_.size(), kMaxToolPoints);
  if (!(std::abs(shares - 1) < kRounding))
    throw UsageError("a tool whose points' shares of its stiffness sum to {}; they must sum to 1", shares);
  last_ = points_;
  times_s_.resize(points_.size());
}

bool ProbeGroup::isFiniteAt(const Pose& pose, const DVec3& origin) const {
  if (!points_.empty() && !isTurn(pose.turn)) return false;
  for (std::uint32_t probe = 0; probe < probes(); ++probe)
    if (!isFinite(Vec3(place(probe, pose) - origin))) return false;
  return true;
}

void ProbeGroup::answered(std::uint32_t probe, const Contact& contact) {
  if (probe == 0) {
    own_ = contact;
    ownPose_ = question_;
    return;
  }
  last_[probe - 1].hip = place(probe, question_);
  last_[probe - 1].contact = contact;
  times_s_[probe - 1] = question_.time_s;
}

void ProbeGroup::give() {
  points_ = last_;
  answer_ = combined(own_, points_, ownPose_.hip);
}

Contact ProbeGroup::heldPoint(std::uint32_t i, const Pose& at) const {
  return heldContact(last_[i].contact, {.time_s = times_s_[i], .hip = last_[i].hip}, at);
}

void ProbeGroup::hold(const Pose& pose) {
  bridge(heldContact(own_, ownPose_, pose), pose, 1,
         [](std::uint32_t, const Pose&) { return std::optional<Contact>(); });
}

void ProbeGroup::forget() {
  for (std::vector<PointContact>* points : {&points_, &last_})
    for (PointContact& point : *points) point.contact.touching = false;
  own_.touching = answer_.touching = false;
}

std::vector<ProbeGroup> makeProbeGroups(std::span<const ToolShape> tools) {
  if (tools.empty() || tools.size() > kMaxHands) throw UsageError("{} hands: must be 1 to {}", tools.size(), kMaxHands);
  std::vector<ProbeGroup> groups;
  for (const ToolShape& tool : tools) groups.emplace_back(tool);
  return groups;
}

}  // namespace palpate
