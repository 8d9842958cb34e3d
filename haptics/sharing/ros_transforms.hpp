// Where frames of ROS stand in one another, from the transforms that programs send (tf). Nothing of DDS is seen here.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "engine/core/depth_stream.hpp"

namespace palpate::sharing {

/// One of a message: from the child's coordinates to its parent's, metres.
struct RosTransform {
  std::string_view parent, child;
  std::int64_t stamp_ns = 0;
  DVec3 translation{0};
  DQuat turn{1, 0, 0, 0};
};

/// As ROS compares names of frames: without a slash before them.
std::string_view rosFrameName(std::string_view name);

/// The tree of frames. Static transforms hold at all times, others from their stamp on until the next one. What is
/// foreign is looked at here: names and numbers, and no more is kept than there is room for.
class RosTransforms {
 public:
  static constexpr std::size_t kMaxFrames = 4096, kLongestName = 256;
  static constexpr std::size_t kKept = 1000;  ///< of a frame that moves: ten seconds at 100 Hz
  static constexpr double kOldest_s = 1;      ///< that the transform of a frame that moves may be

  /// False where it is none, or there is no room for one more frame.
  bool add(const RosTransform& transform, bool isStatic);
  /// From the coordinates of `frame` to those of `target` at that time. Throws NetworkError that says what is missing:
  /// frames that nobody has joined, a circle, or no transform of that time.
  CameraPose find(std::string_view frame, std::string_view target, std::int64_t stamp_ns) const;

 private:
  struct Link {
    std::string parent;
    bool isStatic = false;
    std::map<std::int64_t, CameraPose> poses;  // by stamp; of a static one the only one
  };
  using Links = std::map<std::string, Link, std::less<>>;  // by child
  // Newest, not newer than that.
  static const CameraPose& poseAt(const Links::value_type& link, std::int64_t stamp_ns);

  Links links_;
};

}  // namespace palpate::sharing
