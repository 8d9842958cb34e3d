// Poses of ROS frames in one another, from received transforms (tf). Independent of DDS.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "engine/core/depth_stream.hpp"

namespace palpate::sharing {

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

}  // namespace palpate::sharing
