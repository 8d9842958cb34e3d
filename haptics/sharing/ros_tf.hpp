// Transforms of ROS (tf2_msgs/TFMessage) on the wire: those that others send, and those that palpate sends.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "haptics/sharing/ros.hpp"
#include "haptics/sharing/ros_messages.hpp"
#include "haptics/sharing/ros_transforms.hpp"

namespace palpate::sharing {

/// Hears /tf and /tf_static, and knows where a frame stands in one that was named. For one thread.
class RosTransformIntake {
 public:
  /// `target`: a frame; empty: everything stays in the frame that it is in.
  RosTransformIntake(dds_entity_t participant, const std::string& target);
  /// Whether there is one, which places are to be put in.
  bool isNeeded() const { return hearing_.has_value(); }
  /// From the coordinates of a message's frame to the target's, at its time. Throws NetworkError that says what is
  /// missing.
  CameraPose poseOf(const RosHeader& header);

 private:
  struct Hearing {
    Topic<RosTFMessage> moving, fixed;
    std::vector<Reader<RosTFMessage>> movingReaders, fixedReaders;
    RosTransforms transforms;
  };
  void take();

  std::string target_;
  std::optional<Hearing> hearing_;
};

/// Publishes one transform of a frame in its parent, as a message of its own.
class RosTransformPublisher {
 public:
  /// `isStatic`: on /tf_static, kept for who comes later; otherwise on /tf.
  RosTransformPublisher(dds_entity_t participant, std::string parent, std::string child, bool isStatic);
  bool write(std::int64_t time_ns, const DVec3& place_m, const DQuat& turn);
  operator dds_entity_t() const { return publisher_; }  // NOLINT: as RosPublisher

 private:
  std::string parent_, child_;
  RosPublisher<RosTFMessage> publisher_;
};

/// Where the frame of what is published stands in its parent, kept for who comes later while this lives; nothing where
/// no parent is named.
std::optional<RosTransformPublisher> publishFrame(dds_entity_t participant, const RosPublishing& publishing);

}  // namespace palpate::sharing
