#include "haptics/sharing/ros_tf.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "haptics/sharing/messages.hpp"

namespace palpate::sharing {

namespace {

constexpr std::int32_t kWaiting = 1000;        // unread messages, as many as a robot sends in some seconds
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
    dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, kWaiting);
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
