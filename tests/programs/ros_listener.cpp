// Subscribes to a hand and a cloud of palpate as a ROS program would, so that they are sent over the network, and
// prints the latency of poses:
//   ros_listener DOMAIN NAME SECONDS
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include "haptics/sharing/ros_messages.hpp"

namespace palpate::sharing {

namespace {

template <class T>
class Heard {
 public:
  Heard(dds_entity_t participant, const std::string& topic, RosDelivery delivery)
      : topic_(participant, rosTypeOf<T>().descriptor, kRosTopics + topic),
        reader_(participant, topic_, rosQos(delivery, rosTypeOf<T>())) {}
  void attachTo(ReaderWait& wait) const { wait.attach(reader_); }
  /// Adds the latency of each sample, us.
  void take(std::vector<double>& late_us) const {
    reader_.take([&](const T&, const dds_sample_info_t& about) {
      late_us.push_back(static_cast<double>(dds_time() - about.source_timestamp) * 1e-3);
    });
  }

 private:
  Topic<T> topic_;
  Reader<T> reader_;
};

void listen(std::uint32_t domain, const std::string& name, double seconds) {
  const Participant participant = rosParticipant({.domain = domain});
  const Heard<RosPoseStamped> pose(participant, name + "/pose", RosDelivery::reliable),
      proxy(participant, name + "/proxy", RosDelivery::reliable);
  const Heard<RosWrenchStamped> wrench(participant, name + "/wrench", RosDelivery::reliable);
  const Heard<RosPointCloud2> cloud(participant, name + "/cloud", RosDelivery::latched);
  const Heard<RosTFMessage> frames(participant, "tf", RosDelivery::reliable),
      fixed(participant, "tf_static", RosDelivery::latched);
  std::puts("listening");
  std::fflush(stdout);
  ReaderWait wait(participant);
  pose.attachTo(wait), proxy.attachTo(wait), wrench.attachTo(wait), cloud.attachTo(wait), frames.attachTo(wait),
      fixed.attachTo(wait);
  std::vector<double> poses, others;
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (std::chrono::steady_clock::now() < end) {
    wait.sleep(0.05);
    pose.take(poses);
    proxy.take(others), wrench.take(others), cloud.take(others), frames.take(others), fixed.take(others);
  }
  std::ranges::sort(poses);
  const auto within = [&](double part) {
    return poses.empty() ? 0 : poses[static_cast<std::size_t>(part * static_cast<double>(poses.size() - 1))];
  };
  std::printf("%zu poses and %zu others; latency of poses %.1f us (50 %%), %.1f us (99 %%)\n", poses.size(),
              others.size(), within(0.5), within(0.99));
}

}  // namespace

}  // namespace palpate::sharing

int main(int count, char** words) {
  if (count != 4) return std::fputs("ros_listener DOMAIN NAME SECONDS\n", stderr), 2;
  try {
    palpate::sharing::listen(static_cast<std::uint32_t>(std::atoi(words[1])), words[2], std::atof(words[3]));
  } catch (const std::exception& error) {
    return std::fprintf(stderr, "ros_listener: %s\n", error.what()), 1;
  }
  return 0;
}
