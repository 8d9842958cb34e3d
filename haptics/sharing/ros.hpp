// A hand, and a cloud, for programs of ROS 2 to hear; and clouds and pictures of depth that they send. Nothing of DDS
// is seen here.
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

/// Throws UsageError for what is no name in ROS, of a topic or of a namespace.
void requireRosName(const std::string& name);
/// Throws UsageError for what is no name of a frame (tf), or is not another one than that of `name`.
void requireRosFrame(const std::string& frame);
void requireRosParent(const std::string& parent, const std::string& name);

struct RosPublishing {
  NetworkConfig network;
  std::string name;          ///< of the namespace, and of the frame that all places are in; as ROS has names
  double mm_per_unit = 1;    ///< of coordinates of the file, which go out in metres
  std::string parent = {};   ///< the frame that this one stands in, which goes out on /tf_static; empty: nobody is told
  CameraPose inParent = {};  ///< where it does
};

/// Publishes NAME/pose and NAME/proxy (PoseStamped: where the hand is, and where the surface holds it) and NAME/wrench
/// (WrenchStamped: what the hand feels, N and N m, in the axes of the model), and on /tf the frame NAME/hand in NAME,
/// from a thread of its own, which the servo thread waits for at no time. Stamps are the wall clock's at the first
/// tick, and from there on go with the ticks.
class RosHand final : public TickRecorder {
 public:
  struct Counts {
    std::uint64_t ticks = 0;  ///< that were published, four messages each
    std::uint64_t lost = 0;   ///< ticks for which there was no room
  };
  /// Throws UsageError, NetworkError. `rate_Hz`: by the time of the ticks; where it is more than theirs each is
  /// published.
  RosHand(const RosPublishing& publishing, double rate_Hz);
  ~RosHand() override;
  RosHand(const RosHand&) = delete;
  RosHand& operator=(const RosHand&) = delete;

  void ticked(const TraceRow& row, const DeviceState& device) noexcept override;
  /// After the last tick: sends what is left, and waits a second for those who read it. Throws NetworkError where
  /// something has gone wrong since the beginning.
  Counts finish();

 private:
  class Link;
  std::unique_ptr<Link> link_;
};

/// Publishes NAME/cloud (PointCloud2), kept for who comes later, from a thread of its own.
class RosCloud {
 public:
  /// Throws UsageError, NetworkError.
  explicit RosCloud(const RosPublishing& publishing);
  ~RosCloud();
  RosCloud(const RosCloud&) = delete;
  RosCloud& operator=(const RosCloud&) = delete;

  /// Copies the points and begins to publish them. False where it is still about the last ones: try again later. Throws
  /// NetworkError of the last one.
  bool show(std::span<const PointState> points, const DVec3& origin);
  std::uint64_t shown() const;

 private:
  class Link;
  std::unique_ptr<Link> link_;
};

/// Publishes NAME/camera (PoseStamped): from where a picture is seen, x to its right, y down in it, z where it looks,
/// as optical frames of ROS have it. For one thread.
class RosCamera {
 public:
  /// Throws UsageError, NetworkError.
  explicit RosCamera(const RosPublishing& publishing);
  ~RosCamera();
  RosCamera(const RosCamera&) = delete;
  RosCamera& operator=(const RosCamera&) = delete;

  /// Once for each picture: goes out where it has moved, at most 30 times a second, and twice a second otherwise.
  /// Throws NetworkError.
  void show(const CameraPlace& camera, double mm_per_unit);

 private:
  class Link;
  std::unique_ptr<Link> link_;
};

struct RosListening {
  NetworkConfig network;
  double patience_s = 20;  ///< for who sends, and for the first message
  /// That places are put in, by what is heard on /tf_static and /tf; empty: they stay in that of the message.
  std::string frame = {};
  Log* log = nullptr;
  const std::atomic<bool>* stop = nullptr;  ///< ends it when it becomes true
};
/// The first PointCloud2 that comes on that topic, in metres, whose scale its comments say. Throws UsageError,
/// NetworkError where none comes, it is none, or something else is sent there.
PointCloud hearRosCloud(const std::string& topic, const RosListening& listening);

/// What can be heard on a topic.
enum class RosContent { points, pictures };
/// Which of the two is sent on a topic, as is discovered before a message comes. Throws UsageError, and NetworkError
/// where it is something else, or nobody sends.
RosContent whatRosSends(const std::string& topic, const RosListening& listening);

struct RosWatching {
  RosListening listening;
  std::optional<DepthCamera> camera;  ///< of pictures; nothing: as the CameraInfo beside them says
  double depthScale = 0;              ///< of pictures, values per metre; 0: as their encoding says
  std::string colorTopic =
      {};                      ///< of pictures of colour that are registered with those of depth; empty: none are heard
  bool needsPictures = false;  ///< points are of no use
  unsigned threads = 0;        ///< for normals of points that come without; 0: one per core
};
/// The messages of a topic, PointCloud2 or Image of depth, as frames that come as they are sent: in metres, in the axes
/// of their frame_id. Points that come without normals get some that face the zero of those axes, where a sensor
/// stands. A picture of depth has the colours that were taken with it; without any of its time it is lost, too. Waits
/// for the first good one. What is none, or of another size or frame than the first one, is a lost frame (next() throws
/// NetworkError); after three seconds without any nothing is there. Throws UsageError, NetworkError.
std::shared_ptr<DepthStream> watchRosFrames(const std::string& topic, const RosWatching& watching);

}  // namespace palpate
