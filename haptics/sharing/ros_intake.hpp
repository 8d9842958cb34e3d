// What programs of ROS send on a topic: which type it has, and its messages as they come.
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

/// So often who waits for others looks whether it is to end.
inline constexpr double kRosLook_s = 0.05;

/// Looks for those who write on a topic.
class RosWriters {
 public:
  RosWriters(dds_entity_t participant, std::string topic);
  /// The types that are written there, as far as they are discovered by now.
  const std::vector<std::string>& types();

 private:
  Reader<dds_builtintopic_endpoint_t> discovered_;
  std::string topic_;
  std::vector<std::string> types_;
};

/// "sensor_msgs/msg/Image" of "sensor_msgs::msg::dds_::Image_", for people.
std::string rosTypeInWords(const std::string& type);
/// The first of those types that is sent; nothing where nobody sends yet. Throws NetworkError where others alone are
/// sent.
std::optional<std::string> requireSent(const std::string& topic, RosWriters& writers,
                                       std::initializer_list<const char*> types);

/// The fields of a message of DDS as RosPoints has them; `fields` outlives it.
TakenRosPoints takeMessage(const RosPointCloud2& message, Log* log);

/// Messages of a topic, however they are sent: of large ones no more are kept than are looked at. For one thread.
template <class T>
class RosIntake {
 public:
  RosIntake(dds_entity_t participant, const std::string& topic)
      : topic_(participant, rosTypeOf<T>().descriptor, kRosTopics + topic), wait_(participant) {
    // One that a sensor sends fits the first, a large one comes whole to the second, and the third gets one that was
    // sent before.
    for (const RosDelivery delivery : {RosDelivery::bestEffort, RosDelivery::reliable, RosDelivery::latched}) {
      const Qos qos = rosQos(delivery, rosTypeOf<T>());
      dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, 1);
      wait_.attach(readers_.emplace_back(participant, topic_, qos));
    }
  }
  /// Sleeps until something has come, for so long at most, and shows it: each message once, and none after a later one
  /// of the same writer.
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
  using Sent = std::pair<dds_instance_handle_t, dds_time_t>;  // who has, and when
  // What one reader has had comes to the next one at once, or not at all. Where it is on its way there the next one
  // still has what came before it.
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
  std::vector<Sent> shown_;  // since it slept
  std::size_t next_ = 0;
};

/// Waits for what `isThere` finds, as long as who listens has patience; whether it came. Throws NetworkError where it
/// is to end.
template <class IsThere>
bool waitFor(const RosListening& listening, const std::string& topic, IsThere&& isThere) {
  const Stopwatch since;
  while (!isThere()) {
    if (listening.stop && *listening.stop) throw NetworkError("ros:{}: interrupted", topic);
    if (since.elapsed_s() > listening.patience_s) return false;
  }
  return true;
}

}  // namespace palpate::sharing
