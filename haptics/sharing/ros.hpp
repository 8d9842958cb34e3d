// Publishes a hand, a cloud and a camera for ROS 2 programs, and receives their clouds and depth images. Independent of
// DDS.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/depth_stream.hpp"
#include "engine/core/log.hpp"
#include "engine/core/point_state.hpp"
#include "haptics/servo_loop.hpp"
#include "haptics/shared_presence.hpp"
#include "haptics/sharing/network.hpp"

namespace palpate {

/// Throws UsageError for an invalid ROS name of a topic or namespace.
void requireRosName(const std::string& name);
/// Throws UsageError for an invalid name of a frame (tf), or for a parent that equals the frame of `name`.
void requireRosFrame(const std::string& frame);
void requireRosParent(const std::string& parent, const std::string& name);

struct RosPublishing {
  NetworkConfig network;
  std::string name;          ///< ROS namespace, and frame of all positions
  double mm_per_unit = 1;    ///< of coordinates of the file, which are published in metres
  std::string parent = {};   ///< parent of this frame, published on /tf_static; empty: not published
  CameraPose inParent = {};  ///< pose of this frame in its parent
};

/// Publishes NAME/pose and NAME/proxy (PoseStamped: HIP and proxy), NAME/wrench (WrenchStamped: the force on the hand,
/// N and N m, in the axes of the model), and the frame NAME/hand in NAME on /tf. It publishes on its own thread, which
/// the servo thread never waits for. Stamps begin with the wall clock at the first tick and then follow the time of the
/// ticks.
class RosHand final : public TickRecorder {
 public:
  struct Counts {
    std::uint64_t ticks = 0;  ///< published ticks, four messages each
    std::uint64_t lost = 0;   ///< ticks dropped because the queue was full
  };
  /// Throws UsageError, NetworkError. `rate_Hz`: in the time of the ticks; if it exceeds their rate, each tick is
  /// published.
  RosHand(const RosPublishing& publishing, double rate_Hz);
  ~RosHand() override;
  RosHand(const RosHand&) = delete;
  RosHand& operator=(const RosHand&) = delete;

  void ticked(const TraceRow& row, const DeviceState& device) noexcept override;
  /// After the last tick: sends the remainder, and waits up to a second for its readers. Throws NetworkError if
  /// anything has failed since the start.
  Counts finish();

 private:
  class Link;
  std::unique_ptr<Link> link_;
};

/// Publishes NAME/cloud (PointCloud2) on its own thread; late joiners receive the last one.
class RosCloud {
 public:
  /// Throws UsageError, NetworkError.
  explicit RosCloud(const RosPublishing& publishing);
  ~RosCloud();
  RosCloud(const RosCloud&) = delete;
  RosCloud& operator=(const RosCloud&) = delete;

  /// Copies the points and starts publishing them. False while the previous ones are being published: retry later.
  /// Throws NetworkError if publishing those has failed.
  bool show(std::span<const PointState> points, const DVec3& origin);
  std::uint64_t shown() const;

 private:
  class Link;
  std::unique_ptr<Link> link_;
};

/// Publishes NAME/camera (PoseStamped): the pose of a view, x to the right, y down, z forward, as in optical frames of
/// ROS. Not thread-safe.
class RosCamera {
 public:
  /// Throws UsageError, NetworkError.
  explicit RosCamera(const RosPublishing& publishing);
  ~RosCamera();
  RosCamera(const RosCamera&) = delete;
  RosCamera& operator=(const RosCamera&) = delete;

  /// Call once per picture: published if it has moved, at most 30 times a second, otherwise twice a second. Throws
  /// NetworkError.
  void show(const CameraPlace& camera, double mm_per_unit);

 private:
  class Link;
  std::unique_ptr<Link> link_;
};

struct RosListening {
  NetworkConfig network;
  double timeout_s = 20;  ///< for a sender, and for the first message
  /// Frame to transform positions to, by /tf_static and /tf; empty: they stay in the message's frame.
  std::string frame = {};
  Log* log = nullptr;
  const std::atomic<bool>* stop = nullptr;  ///< ends the wait when it becomes true
};
/// The first PointCloud2 received on that topic, in metres; its comments state the scale. Throws UsageError, and
/// NetworkError if none is received, it is invalid, or the topic has another type.
PointCloud hearRosCloud(const std::string& topic, const RosListening& listening);

/// What a topic carries.
enum class RosContent { points, pictures };
/// Which of the two a topic carries, by discovery, before a message is received. Throws UsageError, and NetworkError if
/// it carries another type or has no sender.
RosContent whatRosSends(const std::string& topic, const RosListening& listening);

struct RosWatching {
  RosListening listening;
  std::optional<DepthCamera> camera;  ///< of depth images; empty: from the CameraInfo beside them
  double depthScale = 0;              ///< of depth images, values per metre; 0: as their encoding says
  std::string colorTopic = {};        ///< of colour images registered to the depth images; empty: none
  bool needsPictures = false;         ///< points are not accepted
  unsigned threads = 0;               ///< for estimating missing normals; 0: one per core
};
/// Messages of a topic, PointCloud2 or depth Image, as frames: in metres, in the axes of their frame_id. Points without
/// normals get estimated ones that face the origin of those axes, where a sensor stands. A depth image has the colours
/// taken with it; without a colour image of its time it is lost, too.
/// Waits for the first valid one. Invalid messages, and those of another size or frame than the first, are lost frames
/// (next() throws NetworkError); after three seconds without a valid one no points are felt. Throws UsageError,
/// NetworkError.
std::shared_ptr<DepthStream> watchRosFrames(const std::string& topic, const RosWatching& watching);

}  // namespace palpate
