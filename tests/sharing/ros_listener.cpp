// Hears a hand and a cloud of palpate, as a program of ROS would, so that somebody has it sent over the network:
//   ros_listener DOMAIN NAME SECONDS
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <thread>

#include "haptics/sharing/ros_messages.hpp"

namespace palpate::sharing {

namespace {

template <class T>
class Heard {
 public:
  Heard(dds_entity_t participant, const std::string& topic, RosDelivery delivery)
      : topic_(participant, rosTypeOf<T>().descriptor, kRosTopics + topic),
        reader_(participant, topic_, rosQos(delivery, rosTypeOf<T>())) {}
  std::size_t take() const { return reader_.take([](const T&) {}); }

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
  std::puts("listening");
  std::fflush(stdout);
  std::size_t poses = 0, wrenches = 0, clouds = 0;
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (std::chrono::steady_clock::now() < end) {
    poses += pose.take() + proxy.take(), wrenches += wrench.take(), clouds += cloud.take();
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  std::printf("%zu poses, %zu wrenches, %zu clouds\n", poses, wrenches, clouds);
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
