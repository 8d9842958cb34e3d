#include <chrono>
#include <future>
#include <thread>
#include <vector>

#include "engine/cloud/length_unit.hpp"
#include "haptics/sharing/ros.hpp"
#include "haptics/sharing/ros_intake.hpp"
#include "haptics/sharing/ros_tf.hpp"

namespace palpate {

using namespace sharing;

class RosCloud::Link {
 public:
  explicit Link(const RosPublishing& publishing)
      : publishing_(publishing),
        frame_(rosName(publishing.name)),
        participant_(rosParticipant(publishing.network)),
        clouds_(participant_, kRosTopics + frame_ + "/cloud", RosDelivery::latched),
        stands_(publishFrame(participant_, publishing)) {
    for (const RosField& field : fieldsOfRosPoints()) {
      names_.emplace_back(field.name);
      fields_.push_back({.offset = field.offset, .datatype = field.type, .count = field.count});
    }
    for (std::size_t i = 0; i < fields_.size(); ++i) fields_[i].name = names_[i].data();
  }

  bool show(std::span<const PointState> points, const DVec3& origin) {
    if (writing_.valid()) {
      if (writing_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return false;
      shown_ += writing_.get();
    }
    data_ = rosDataOf(points, origin, publishing_.mm_per_unit);
    writing_ = std::async(std::launch::async, [this] { return write(); });
    return true;
  }
  std::uint64_t shown() const { return shown_; }

 private:
  // Where those who read are not done with the last one it is left out, as it would be by ROS.
  bool write() {
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    RosPointCloud2 cloud{};
    setStamp(cloud.header, std::chrono::duration_cast<std::chrono::nanoseconds>(now).count());
    cloud.header.frame_id = frame_.data();
    cloud.height = 1;
    cloud.width = static_cast<std::uint32_t>(data_.size() / kRosPointStep);
    cloud.fields._buffer = fields_.data();
    cloud.fields._length = cloud.fields._maximum = static_cast<std::uint32_t>(fields_.size());
    cloud.point_step = kRosPointStep;
    cloud.row_step = static_cast<std::uint32_t>(data_.size());
    cloud.data._buffer = data_.data();
    cloud.data._length = cloud.data._maximum = cloud.row_step;
    cloud.is_dense = true;
    return clouds_.write(cloud);
  }

  RosPublishing publishing_;
  std::string frame_;
  std::vector<std::string> names_;
  std::vector<RosPointField> fields_;
  std::vector<std::uint8_t> data_;
  Participant participant_;
  RosPublisher<RosPointCloud2> clouds_;
  std::optional<RosTransformPublisher> stands_;
  std::uint64_t shown_ = 0;
  std::future<bool> writing_;  // ends before all that it uses
};

RosCloud::RosCloud(const RosPublishing& publishing) : link_(std::make_unique<Link>(publishing)) {}
RosCloud::~RosCloud() = default;
bool RosCloud::show(std::span<const PointState> points, const DVec3& origin) { return link_->show(points, origin); }
std::uint64_t RosCloud::shown() const { return link_->shown(); }

namespace {

void putInFrame(PointCloud& cloud, const CameraPose& pose) {
  cloud.origin = pose.toWorld(cloud.origin);
  for (Vec3& position : cloud.positions) position = Vec3(pose.turn * DVec3(position));
  for (Vec3& normal : cloud.normals) normal = Vec3(pose.turn * DVec3(normal));
}

// What says where a frame stands may come after what is in it.
CameraPose awaitPose(RosTransformIntake& transforms, const RosHeader& header, const std::string& topic,
                     const RosListening& listening) {
  std::string why;
  std::optional<CameraPose> pose;
  const bool came = waitFor(listening, topic, [&] {
    try {
      pose = transforms.poseOf(header);
    } catch (const NetworkError& error) {
      why = error.what();
      std::this_thread::sleep_for(std::chrono::duration<double>(kRosLook_s));
    }
    return pose.has_value();
  });
  if (!came) throw NetworkError("ros:{}: {}", topic, why);
  return *pose;
}

}  // namespace

PointCloud hearRosCloud(const std::string& topic, const RosListening& listening) {
  constexpr double kMmPerMetre = 1000;
  const std::string name = rosName(topic);
  const Participant participant = rosParticipant(listening.network);
  RosIntake<RosPointCloud2> clouds(participant, name);
  RosWriters writers(participant, name);
  if (listening.log) listening.log->say("ros:{}: waiting for a PointCloud2", topic);
  RosTransformIntake transforms(participant, listening.frame);
  std::optional<TakenRosPoints> taken;
  std::string frame;
  RosHeader header{};
  const bool came = waitFor(listening, topic, [&] {
    clouds.take(kRosLook_s, [&](const RosPointCloud2& message) {
      if (taken) return;
      taken = takeMessage(message, listening.log);
      frame = message.header.frame_id ? message.header.frame_id : "";
      header.stamp = message.header.stamp;
    });
    if (!taken) requireSent(topic, writers, {rosTypeOf<RosPointCloud2>().name()});
    return taken.has_value();
  });
  if (!came)
    throw NetworkError(
        "ros:{}: no PointCloud2 has come in {:g} s; is the topic sent on domain {}, and on this network?", topic,
        listening.patience_s, listening.network.domain);
  if (taken->cloud.empty())
    throw NetworkError("ros:{}: a PointCloud2 has come without a point that has a place ({} have none)", topic,
                       taken->skipped);
  if (listening.log)
    listening.log->say("ros:{}: {} points{}", topic, taken->cloud.size(),
                       taken->skipped > 0 ? fmt::format("; {} without a place are left out", taken->skipped) : "");
  if (transforms.isNeeded()) {
    header.frame_id = frame.data();
    putInFrame(taken->cloud, awaitPose(transforms, header, topic, listening));
  }
  sayScale(taken->cloud.storedAs.comments, kMmPerMetre);
  return std::move(taken->cloud);
}

}  // namespace palpate
