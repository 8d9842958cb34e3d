#include "haptics/sharing/ros_tf.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>
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
  constexpr double kMaxDistance_m = 1e9, kUnit = 1e-2;
  const DVec3& at = transform.translation;
  return std::abs(at.x) <= kMaxDistance_m && std::abs(at.y) <= kMaxDistance_m && std::abs(at.z) <= kMaxDistance_m &&
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

constexpr std::int32_t kMaxUnread = 1000;      // unread messages, as many as a robot sends in some seconds
constexpr std::uint32_t kMaxOfMessage = 4096;  // transforms of one message that are read

const std::string kMovingTopic = kRosTopics + "tf", kFixedTopic = kRosTopics + "tf_static";

std::string_view textOf(const char* text) { return text ? text : ""; }

RosTransform transformOf(const geometry_msgs_msg_dds__TransformStamped_& sent) {
  const auto& [translation, rotation] = sent.transform;
  return {.parent = textOf(sent.header.frame_id),
          .child = textOf(sent.child_frame_id),
          .stamp_ns = stampOf(sent.header),
          .translation = DVec3(translation.x, translation.y, translation.z),
          .turn = DQuat(rotation.w, rotation.x, rotation.y, rotation.z)};
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

RosTransformIntake::RosTransformIntake(dds_entity_t participant, const std::string& target) : target_(target) {
  if (target.empty()) return;
  const RosType type = rosTypeOf<RosTFMessage>();
  hearing_.emplace(Hearing{.moving = {participant, type.descriptor, kMovingTopic},
                           .fixed = {participant, type.descriptor, kFixedTopic},
                           .movingReaders = {},
                           .fixedReaders = {},
                           .transforms = {}});
  // Best-effort senders match only the first reader; earlier messages reach only the last one.
  for (const RosDelivery delivery : {RosDelivery::bestEffort, RosDelivery::reliable, RosDelivery::latched}) {
    const Qos qos = rosQos(delivery, type);
    dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, kMaxUnread);
    if (delivery != RosDelivery::latched) hearing_->movingReaders.emplace_back(participant, hearing_->moving, qos);
    hearing_->fixedReaders.emplace_back(participant, hearing_->fixed, qos);
  }
}

void RosTransformIntake::take() {
  const auto from = [&](const std::vector<Reader<RosTFMessage>>& readers, bool isStatic) {
    for (const auto& reader : readers)
      reader.take([&](const RosTFMessage& message) {
        for (std::uint32_t i = 0; i < std::min(message.transforms._length, kMaxOfMessage); ++i)
          hearing_->transforms.add(transformOf(message.transforms._buffer[i]), isStatic);
      });
  };
  from(hearing_->fixedReaders, true);
  from(hearing_->movingReaders, false);
}

CameraPose RosTransformIntake::poseOf(const RosHeader& header) {
  take();
  return hearing_->transforms.find(textOf(header.frame_id), target_, stampOf(header));
}

RosTransformPublisher::RosTransformPublisher(dds_entity_t participant, std::string parent, std::string child,
                                             bool isStatic)
    : parent_(std::move(parent)),
      child_(std::move(child)),
      publisher_(participant, isStatic ? kFixedTopic : kMovingTopic,
                 isStatic ? RosDelivery::latched : RosDelivery::reliable) {}

bool RosTransformPublisher::write(std::int64_t time_ns, const DVec3& place_m, const DQuat& turn) {
  geometry_msgs_msg_dds__TransformStamped_ transform{};
  setStamp(transform.header, time_ns);
  transform.header.frame_id = parent_.data();
  transform.child_frame_id = child_.data();
  transform.transform.translation = {place_m.x, place_m.y, place_m.z};
  transform.transform.rotation = {turn.x, turn.y, turn.z, turn.w};
  return publisher_.write({.transforms = {._maximum = 1, ._length = 1, ._buffer = &transform, ._release = false}});
}

std::optional<RosTransformPublisher> publishFrame(dds_entity_t participant, const RosPublishing& publishing) {
  if (publishing.parent.empty()) return std::nullopt;
  const std::string frame = rosName(publishing.name);
  requireRosParent(publishing.parent, frame);
  std::optional<RosTransformPublisher> made;
  made.emplace(participant, std::string(rosFrameName(publishing.parent)), frame, true);
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  made->write(std::chrono::duration_cast<std::chrono::nanoseconds>(now).count(), publishing.inParent.centre,
              publishing.inParent.turn);
  return made;
}

}  // namespace palpate::sharing

namespace palpate {

void requireRosParent(const std::string& parent, const std::string& name) {
  using namespace sharing;
  requireRosFrame(parent);
  if (rosFrameName(parent) == rosFrameName(name))
    throw UsageError("ros: the frame '{}' cannot be its own parent", name);
}

void requireRosFrame(const std::string& frame) {
  using namespace sharing;
  const std::string_view name = rosFrameName(frame);
  if (name.empty() || name.size() > RosTransforms::kLongestName ||
      std::ranges::any_of(name, [](unsigned char c) { return c < 0x20; }))
    throw UsageError("ros: '{}' is not a valid name of a frame: 1 to {} bytes", printable(frame.c_str()),
                     RosTransforms::kLongestName);
}

}  // namespace palpate
