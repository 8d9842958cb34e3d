// Transforms of ROS (tf2_msgs/TFMessage) on the wire, received and sent.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "haptics/sharing/ros.hpp"
#include "haptics/sharing/ros_messages.hpp"
#include "haptics/sharing/ros_transforms.hpp"

namespace palpate::sharing {

/// Receives /tf and /tf_static, and finds poses of frames in a target frame. Not thread-safe.
class RosTransformIntake {
 public:
  /// `target`: a frame; empty: positions stay in their own frame.
  RosTransformIntake(dds_entity_t participant, const std::string& target);
  /// Whether there is a target.
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
  /// `isStatic`: on /tf_static, kept for late joiners; otherwise on /tf.
  RosTransformPublisher(dds_entity_t participant, std::string parent, std::string child, bool isStatic);
  bool write(std::int64_t time_ns, const DVec3& place_m, const DQuat& turn);
  operator dds_entity_t() const { return publisher_; }  // NOLINT: as RosPublisher

 private:
  std::string parent_, child_;
  RosPublisher<RosTFMessage> publisher_;
};

/// Publishes the pose of the published frame in its parent, kept for late joiners while this lives; nothing if no
/// parent is named.
std::optional<RosTransformPublisher> publishFrame(dds_entity_t participant, const RosPublishing& publishing);

}  // namespace palpate::sharing
