#include <chrono>
#include <optional>

#include "engine/core/clock.hpp"
#include "haptics/sharing/ros.hpp"
#include "haptics/sharing/ros_messages.hpp"

namespace palpate {

using namespace sharing;

class RosCamera::Link {
 public:
  explicit Link(const RosPublishing& publishing)
      : frame_(rosName(publishing.name)),
        participant_(rosParticipant(publishing.network)),
        poses_(participant_, kRosTopics + frame_ + "/camera", RosDelivery::reliable) {}

  void show(const CameraPlace& camera, double mm_per_unit) {
    constexpr double kMoved_s = 1.0 / 30, kBeat_s = 0.5, kMetresPerMm = 1e-3;
    if (shown_ && since_.elapsed_s() < (shown_ == camera ? kBeat_s : kMoved_s)) return;
    since_ = {};
    shown_ = camera;
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    RosPoseStamped pose{};
    setStamp(pose.header, std::chrono::duration_cast<std::chrono::nanoseconds>(now).count());
    pose.header.frame_id = frame_.data();
    const DVec3 at = camera.position * (mm_per_unit * kMetresPerMm);
    pose.pose.position = {at.x, at.y, at.z};
    pose.pose.orientation = {camera.turn.x, camera.turn.y, camera.turn.z, camera.turn.w};
    poses_.write(pose);  // for slow readers the next pose is as good
  }

 private:
  std::string frame_;
  Participant participant_;
  RosPublisher<RosPoseStamped> poses_;
  std::optional<CameraPlace> shown_;
  Stopwatch since_;
};

RosCamera::RosCamera(const RosPublishing& publishing) : link_(std::make_unique<Link>(publishing)) {}
RosCamera::~RosCamera() = default;
void RosCamera::show(const CameraPlace& camera, double mm_per_unit) { link_->show(camera, mm_per_unit); }

}  // namespace palpate
