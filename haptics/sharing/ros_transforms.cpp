#include "haptics/sharing/ros_transforms.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "haptics/sharing/messages.hpp"
#include "haptics/sharing/network.hpp"

namespace palpate::sharing {

namespace {

constexpr std::size_t kMaxAncestors = 256;
constexpr double kBack_ns = 10e9;           // messages are not reordered by more than this
constexpr std::size_t kMaxPoses = 200'000;  // of all frames together, approximately: each keeps some
constexpr std::size_t kFewestPoses = 10;

bool isName(std::string_view name) { return !name.empty() && name.size() <= RosTransforms::kLongestName; }

bool isPose(const RosTransform& transform) {
  constexpr double kFarthest_m = 1e9, kUnit = 1e-2;
  const DVec3& at = transform.translation;
  return std::abs(at.x) <= kFarthest_m && std::abs(at.y) <= kFarthest_m && std::abs(at.z) <= kFarthest_m &&
         std::abs(glm::length(transform.turn) - 1) < kUnit;
}

/// First `inner`, then `outer`.
CameraPose composed(const CameraPose& outer, const CameraPose& inner) {
  return {.turn = glm::normalize(outer.turn * inner.turn), .centre = outer.toWorld(inner.centre)};
}

CameraPose inverse(const CameraPose& pose) {
  const DQuat back = glm::conjugate(pose.turn);
  return {.turn = back, .centre = back * -pose.centre};
}

}  // namespace

std::string_view rosFrameName(std::string_view name) { return name.starts_with('/') ? name.substr(1) : name; }

bool RosTransforms::add(const RosTransform& transform, bool isStatic) {
  const std::string_view parent = rosFrameName(transform.parent), child = rosFrameName(transform.child);
  if (!isName(parent) || !isName(child) || parent == child || !isPose(transform)) return false;
  auto found = links_.find(child);
  if (found == links_.end()) {
    if (links_.size() >= kMaxFrames) return false;
    found = links_.emplace(std::string(child), Link{}).first;
  }
  Link& link = found->second;
  // A frame with a new parent starts again.
  if (link.parent != parent || link.isStatic != isStatic || isStatic) link.poses.clear();
  link.parent = parent;
  link.isStatic = isStatic;
  // Time has gone back, as in a recording that restarts: earlier poses are no longer the past.
  if (!isStatic && !link.poses.empty() &&
      static_cast<double>(link.poses.rbegin()->first) - static_cast<double>(transform.stamp_ns) > kBack_ns)
    link.poses.clear();
  link.poses[isStatic ? 0 : transform.stamp_ns] = {.turn = glm::normalize(transform.turn),
                                                   .centre = transform.translation};
  const std::size_t kept = std::clamp(kMaxPoses / links_.size(), kFewestPoses, kKept);
  while (link.poses.size() > kept) link.poses.erase(link.poses.begin());
  return true;
}

const CameraPose& RosTransforms::poseAt(const Links::value_type& of, std::int64_t stamp_ns) {
  const auto& [child, link] = of;
  if (link.isStatic) return link.poses.begin()->second;
  const auto after = link.poses.upper_bound(stamp_ns);
  if (after == link.poses.begin())
    throw NetworkError(
        "the pose of the frame '{}' in '{}' is unknown at its time: the oldest one received is {:.3f} s newer",
        printable(child.c_str()), printable(link.parent.c_str()),
        1e-9 * (static_cast<double>(after->first) - static_cast<double>(stamp_ns)));
  const auto& [at_ns, pose] = *std::prev(after);
  const double age_s = 1e-9 * (static_cast<double>(stamp_ns) - static_cast<double>(at_ns));
  if (age_s > kOldest_s)
    throw NetworkError("the pose of the frame '{}' in '{}' was received {:.3f} s before its time, and is too old",
                       printable(child.c_str()), printable(link.parent.c_str()), age_s);
  return pose;
}

CameraPose RosTransforms::find(std::string_view from, std::string_view to, std::int64_t stamp_ns) const {
  const std::string_view frame = rosFrameName(from), target = rosFrameName(to);
  std::string why = fmt::format("is in the frame '{}', from which no transform on /tf_static and /tf leads to '{}'",
                                printable(std::string(frame).c_str()), printable(std::string(target).c_str()));
  struct Ancestor {
    std::string_view name;
    CameraPose pose;  // from the coordinates of the first frame to this one's
  };
  const auto above = [&](const Ancestor& one) -> std::optional<Ancestor> {
    const auto link = links_.find(one.name);
    if (link == links_.end()) return std::nullopt;
    try {
      return Ancestor{link->second.parent, composed(poseAt(*link, stamp_ns), one.pose)};
    } catch (const NetworkError& error) {  // perhaps the frames beyond it are not needed
      why = error.what();
      return std::nullopt;
    }
  };
  std::vector<Ancestor> ancestors{{frame, {}}};
  while (ancestors.back().name != target && ancestors.size() <= kMaxAncestors) {
    const auto next = above(ancestors.back());
    if (!next) break;
    ancestors.push_back(*next);
  }
  if (ancestors.size() > kMaxAncestors)
    throw NetworkError("the frames above '{}' form a cycle, or are more than {}", printable(std::string(frame).c_str()),
                       kMaxAncestors);
  std::optional<Ancestor> up = Ancestor{target, {}};
  for (std::size_t steps = 0; up && steps <= kMaxAncestors; ++steps) {
    const auto common = std::ranges::find(ancestors, up->name, &Ancestor::name);
    if (common != ancestors.end()) return composed(inverse(up->pose), common->pose);
    up = above(*up);
  }
  throw NetworkError("{}", why);
}

}  // namespace palpate::sharing
