// What programs of ROS send on a topic: its type, and its messages as they are received.
#pragma once

#include <algorithm>
#include <array>
#include <initializer_list>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/clock.hpp"
#include "haptics/sharing/ros.hpp"
#include "haptics/sharing/ros_messages.hpp"
#include "haptics/sharing/ros_points.hpp"

namespace palpate::sharing {

/// How often waiting functions check whether to stop.
inline constexpr double kRosLook_s = 0.05;

/// Finds the writers of a topic.
class RosWriters {
 public:
  RosWriters(dds_entity_t participant, std::string topic);
  /// The types written there, as far as discovered.
  const std::vector<std::string>& types();

 private:
  Reader<dds_builtintopic_endpoint_t> discovered_;
  std::string topic_;
  std::vector<std::string> types_;
};

/// "sensor_msgs/msg/Image" for "sensor_msgs::msg::dds_::Image_", for display.
std::string rosTypeInWords(const std::string& type);
/// The first of those types that is sent; nothing if there is no sender yet. Throws NetworkError if only other types
/// are sent.
std::optional<std::string> requireSent(const std::string& topic, RosWriters& writers,
                                       std::initializer_list<const char*> types);

/// takeRosPoints() of a message of DDS.
TakenRosPoints takeMessage(const RosPointCloud2& message, Log* log);

/// Messages of a topic, whatever their delivery. Keeps only one message per reader, since they may be large. Not
/// thread-safe.
template <class T>
class RosIntake {
 public:
  RosIntake(dds_entity_t participant, const std::string& topic)
      : topic_(participant, rosTypeOf<T>().descriptor, kRosTopics + topic), wait_(participant) {
    // The first reader matches sensors, the second receives large messages whole, the third receives one that was sent
    // earlier.
    for (const RosDelivery delivery : {RosDelivery::bestEffort, RosDelivery::reliable, RosDelivery::latched}) {
      const Qos qos = rosQos(delivery, rosTypeOf<T>());
      dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, 1);
      wait_.attach(readers_.emplace_back(participant, topic_, qos));
    }
  }
  /// Sleeps until something is received, `most_s` at most, and passes it to `visit`: each message once, and none after
  /// a later one of the same writer.
  template <class Visit>
  void take(double most_s, Visit&& visit) {
    wait_.sleep(most_s);
    shown_.clear();
    for (const auto& reader : readers_)
      reader.take([&](const T& message, const dds_sample_info_t& about) {
        if (isNew({about.publication_handle, about.source_timestamp})) visit(message);
      });
  }

 private:
  using Sent = std::pair<dds_instance_handle_t, dds_time_t>;  // writer and time
  // A message that one reader has had reaches the next reader at once or not at all. While it is in flight there, the
  // next reader still holds the message before it.
  bool isNew(const Sent& sent) {
    const auto isLater = [&](const Sent& other) { return other.first == sent.first && other.second > sent.second; };
    if (std::ranges::count(seen_, sent) > 0 || std::ranges::any_of(shown_, isLater)) return false;
    seen_[next_++ % seen_.size()] = sent;
    shown_.push_back(sent);
    return true;
  }

  Topic<T> topic_;
  ReaderWait wait_;
  std::vector<Reader<T>> readers_;
  std::array<Sent, 16> seen_{};
  std::vector<Sent> shown_;  // since the last sleep
  std::size_t next_ = 0;
};

/// Waits until `isThere` returns true or the patience ends; returns whether it did. Throws NetworkError if it is to
/// stop.
template <class IsThere>
bool waitFor(const RosListening& listening, const std::string& topic, IsThere&& isThere) {
  const Stopwatch since;
  while (!isThere()) {
    if (listening.stop && *listening.stop) throw NetworkError("ros:{}: interrupted", topic);
    if (since.elapsed_s() > listening.timeout_s) return false;
  }
  return true;
}

}  // namespace palpate::sharing
