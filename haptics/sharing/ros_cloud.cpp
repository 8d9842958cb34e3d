#include <chrono>
#include <future>
#include <vector>

#include "engine/cloud/length_unit.hpp"
#include "engine/core/clock.hpp"
#include "haptics/sharing/messages.hpp"
#include "haptics/sharing/ros.hpp"
#include "haptics/sharing/ros_messages.hpp"
#include "haptics/sharing/ros_points.hpp"

namespace palpate {

using namespace sharing;

class RosCloud::Link {
 public:
  explicit Link(const RosPublishing& publishing)
      : publishing_(publishing),
        frame_(rosName(publishing.name)),
        participant_(rosParticipant(publishing.network)),
        clouds_(participant_, kRosTopics + frame_ + "/cloud", RosDelivery::latched) {
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
  std::uint64_t shown_ = 0;
  std::future<bool> writing_;  // ends before all that it uses
};

RosCloud::RosCloud(const RosPublishing& publishing) : link_(std::make_unique<Link>(publishing)) {}
RosCloud::~RosCloud() = default;
bool RosCloud::show(std::span<const PointState> points, const DVec3& origin) { return link_->show(points, origin); }
std::uint64_t RosCloud::shown() const { return link_->shown(); }

TakenRosPoints sharing::takeRosCloud(const RosPointCloud2& message, Log* log) {
  std::vector<RosField> fields;
  for (std::uint32_t i = 0; i < message.fields._length; ++i) {
    const RosPointField& field = message.fields._buffer[i];
    fields.push_back(
        {.name = field.name ? field.name : "", .offset = field.offset, .type = field.datatype, .count = field.count});
  }
  return takeRosPoints({.height = message.height,
                        .width = message.width,
                        .fields = fields,
                        .isBigEndian = message.is_bigendian,
                        .pointStep = message.point_step,
                        .rowStep = message.row_step,
                        .data = {message.data._buffer, message.data._length},
                        .isDense = message.is_dense},
                       log);
}

PointCloud hearRosCloud(const std::string& topic, const RosListening& listening) {
  constexpr double kLook_s = 0.05, kMmPerMetre = 1000;
  const std::string name = kRosTopics + rosName(topic);
  const Participant participant = rosParticipant(listening.network);
  const RosType type = rosTypeOf<RosPointCloud2>();
  const Topic<RosPointCloud2> clouds(participant, type.descriptor, name);
  // One that a sensor sends fits the first, a large one comes whole to the second, and the third gets one that was sent
  // before.
  std::vector<Reader<RosPointCloud2>> readers;
  ReaderWait wait(participant);
  for (const RosDelivery delivery : {RosDelivery::bestEffort, RosDelivery::reliable, RosDelivery::latched}) {
    const Qos qos = rosQos(delivery, type);
    dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, 1);  // of large ones no more are kept than are looked at
    wait.attach(readers.emplace_back(participant, clouds, qos));
  }
  if (listening.log) listening.log->say("ros:{}: waiting for a PointCloud2", topic);
  std::optional<TakenRosPoints> taken;
  const Stopwatch since;
  while (!taken) {
    if (listening.stop && *listening.stop) throw NetworkError("ros:{}: interrupted", topic);
    if (since.elapsed_s() > listening.patience_s)
      throw NetworkError(
          "ros:{}: no PointCloud2 has come in {:g} s; is the topic sent on domain {}, and on this network?", topic,
          listening.patience_s, listening.network.domain);
    wait.sleep(kLook_s);
    for (const auto& reader : readers)
      reader.take([&](const RosPointCloud2& message) {
        if (!taken) taken = takeRosCloud(message, listening.log);
      });
  }
  if (taken->cloud.empty())
    throw NetworkError("ros:{}: a PointCloud2 has come without a point that has a place ({} have none)", topic,
                       taken->skipped);
  if (listening.log)
    listening.log->say("ros:{}: {} points{}", topic, taken->cloud.size(),
                       taken->skipped > 0 ? fmt::format("; {} without a place are left out", taken->skipped) : "");
  sayScale(taken->cloud.storedAs.comments, kMmPerMetre);
  return std::move(taken->cloud);
}

}  // namespace palpate
