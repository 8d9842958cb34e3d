// Transforms of ROS (tf2_msgs/TFMessage) on the wire, received and sent.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/depth_stream.hpp"
#include "haptics/sharing/ros.hpp"
#include "haptics/sharing/ros_messages.hpp"

namespace palpate::sharing {

/// Poses of ROS frames in one another, from received transforms (tf). Independent of DDS.
/// Transform of a message: from the child's coordinates to its parent's, metres.
struct RosTransform {
  std::string_view parent, child;
  std::int64_t stamp_ns = 0;
  DVec3 translation{0};
  DQuat turn{1, 0, 0, 0};
};

/// Name of a frame as ROS compares it: without a leading slash.
std::string_view rosFrameName(std::string_view name);

/// The tree of frames. Static transforms hold at all times, others from their stamp until the next one. Foreign names
/// and numbers are validated here, and the memory is bounded.
class RosTransforms {
 public:
  static constexpr std::size_t kMaxFrames = 4096, kLongestName = 256;
  static constexpr std::size_t kKept = 1000;  ///< transforms kept of a moving frame: ten seconds at 100 Hz
  static constexpr double kOldest_s = 1;      ///< maximum age of a transform of a moving frame

  /// False if the transform is invalid, or there is no room for one more frame.
  bool add(const RosTransform& transform, bool isStatic);
  /// From the coordinates of `frame` to those of `target` at that time. Throws NetworkError that says what is missing:
  /// unconnected frames, a cycle, or no transform of that time.
  CameraPose find(std::string_view frame, std::string_view target, std::int64_t stamp_ns) const;

 private:
  struct Link {
    std::string parent;
    bool isStatic = false;
    std::map<std::int64_t, CameraPose> poses;  // by stamp; a static link has only one
  };
  using Links = std::map<std::string, Link, std::less<>>;  // by child
  // The newest pose up to that time.
  static const CameraPose& poseAt(const Links::value_type& link, std::int64_t stamp_ns);

  Links links_;
};

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
