#include <chrono>
#include <future>
#include <optional>
#include <string>
#include <vector>

#include "engine/cloud/length_unit.hpp"
#include "engine/cloud/up.hpp"
#include "engine/core/counted.hpp"
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
  // Drops the cloud if readers are not done with the previous one, as ROS would.
  bool write() {
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    RosPointCloud2 cloud{};
    setStamp(cloud.header, std::chrono::duration_cast<std::chrono::nanoseconds>(now).count());
    cloud.header.frame_id = frame_.data();
    cloud.height = 1;
    cloud.width = static_cast<std::uint32_t>(data_.size() / kRosPointStep);
    give(cloud.fields, fields_);
    cloud.point_step = kRosPointStep;
    cloud.row_step = static_cast<std::uint32_t>(data_.size());
    give(cloud.data, data_);
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
  std::future<bool> writing_;  // destroyed before all that it uses
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

// The first message whose pose is known; its transform may be received later than the message.
class FirstCloud {
 public:
  FirstCloud(dds_entity_t participant, const std::string& name, const RosListening& listening)
      : listening_(listening), clouds_(participant, name), transforms_(participant, listening.frame) {}

  bool look() {
    clouds_.take(kRosLook_s, [&](const RosPointCloud2& message) {
      if (isPlaced_) return;
      taken_ = takeMessage(message, taken_ ? nullptr : listening_.log);
      frame_ = message.header.frame_id ? message.header.frame_id : "";
      stamp_ = message.header.stamp;
    });
    if (taken_ && !isPlaced_) place();
    return isPlaced_;
  }
  bool hasCome() const { return taken_.has_value(); }
  /// Why its pose is unknown.
  const std::string& why() const { return why_; }
  TakenRosPoints& taken() { return *taken_; }

 private:
  void place() {
    isPlaced_ = !transforms_.isNeeded();
    if (isPlaced_) return;
    try {
      putInFrame(taken_->cloud, transforms_.poseOf({.stamp = stamp_, .frame_id = frame_.data()}));
      isPlaced_ = true;
    } catch (const NetworkError& error) {
      why_ = error.what();
    }
  }

  const RosListening& listening_;
  RosIntake<RosPointCloud2> clouds_;
  RosTransformIntake transforms_;
  std::optional<TakenRosPoints> taken_;
  std::string frame_, why_;
  decltype(RosHeader::stamp) stamp_{};
  bool isPlaced_ = false;
};

}  // namespace

PointCloud hearRosCloud(const std::string& topic, const RosListening& listening) {
  constexpr double kMmPerMetre = 1000;
  const std::string name = rosName(topic);
  const Participant participant = rosParticipant(listening.network);
  FirstCloud first(participant, name, listening);
  RosWriters writers(participant, name);
  if (listening.log) listening.log->say("ros:{}: waiting for a PointCloud2", topic);
  const bool came = waitFor(listening, topic, [&] {
    if (first.look()) return true;
    if (!first.hasCome()) requireSent(topic, writers, {rosTypeOf<RosPointCloud2>().name()});
    return false;
  });
  if (!came && first.hasCome()) throw NetworkError("ros:{}: {}", topic, first.why());
  if (!came)
    throw NetworkError(
        "ros:{}: no PointCloud2 was received in {:g} s; is the topic sent on domain {}, and on this network?", topic,
        listening.timeout_s, listening.network.domain);
  TakenRosPoints& taken = first.taken();
  if (taken.cloud.empty())
    throw NetworkError("ros:{}: the received PointCloud2 has no point with a valid position ({} without)", topic,
                       taken.skipped);
  if (listening.log)
    listening.log->say(
        "ros:{}: {}{}", topic, counted(taken.cloud.size(), "point"),
        taken.skipped > 0 ? fmt::format("; {} without a valid position are left out", taken.skipped) : "");
  sayScale(taken.cloud.storedAs.comments, kMmPerMetre);
  sayUnit(taken.cloud.storedAs.comments, LengthUnit::m);
  // REP 103: z is up in all frames but those of a camera.
  if (!listening.frame.empty())
    taken.cloud.storedAs.comments.push_back(fmt::format("comment up: {}", nameOf(UpAxis::z)));
  return std::move(taken.cloud);
}

}  // namespace palpate
