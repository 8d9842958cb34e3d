// ROS messages on the network of this machine: their bytes, what others discover about their writers, and clouds and
// hands end to end.
#include "haptics/sharing/ros_messages.hpp"

#include <dds/ddsi/ddsi_serdata.h>
#include <doctest/doctest.h>

#include <chrono>
#include <cmath>
#include <ctime>
#include <map>
#include <thread>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/cloud/length_unit.hpp"
#include "engine/core/clock.hpp"
#include "haptics/sharing/ros.hpp"
#include "haptics/sharing/ros_points.hpp"
#include "tests/error_of.hpp"
#include "tests/near.hpp"
#include "tests/says.hpp"
#include "tests/sharing/own_network.hpp"
#include "tests/sharing/ros_discovery.hpp"

namespace palpate::ros_messages_test {

using namespace sharing;

namespace {

std::string hexOf(const std::vector<std::uint8_t>& bytes) {
  std::string hex;
  for (const std::uint8_t byte : bytes) hex += fmt::format("{:02x}", byte);
  return hex;
}

std::string withoutSpaces(std::string text) {
  std::erase(text, ' ');
  return text;
}

/// A message in wire format, including its encapsulation.
template <class T>
std::string wireOf(const T& message) {
  const Participant participant = rosParticipant(ownNetwork());
  const RosType type = rosTypeOf<T>();
  const RosPublisher<T> publisher(participant, "rt/bytes", RosDelivery::reliable);
  const Topic<T> topic(participant, type.descriptor, "rt/bytes");
  const Reader<T> reader(participant, topic, rosQos(RosDelivery::reliable, type));
  CHECK(publisher.write(message));
  ddsi_serdata* taken = nullptr;
  dds_sample_info_t about;
  REQUIRE(within(5, [&] { return dds_takecdr(reader, &taken, 1, &about, DDS_ANY_STATE) == 1; }));
  std::vector<std::uint8_t> bytes(ddsi_serdata_size(taken));
  ddsi_serdata_to_ser(taken, 0, bytes.size(), bytes.data());
  ddsi_serdata_unref(taken);
  return hexOf(bytes);
}

char text[] = "x";

/// All messages of a topic, of which none is replaced by a later one.
template <class T>
class AllOf {
 public:
  AllOf(dds_entity_t participant, const std::string& topic, RosDelivery delivery = RosDelivery::reliable)
      : topic_(participant, rosTypeOf<T>().descriptor, topic), reader_(participant, topic_, qosOf(delivery)) {}
  bool hasWriter() const {
    dds_subscription_matched_status_t matched{};
    return dds_get_subscription_matched_status(reader_, &matched) == 0 && matched.current_count == 1;
  }
  template <class Visit>
  std::size_t take(Visit&& visit) const {
    return reader_.take(visit);
  }

 private:
  static Qos qosOf(RosDelivery delivery) {
    Qos qos = rosQos(delivery, rosTypeOf<T>());
    if (delivery != RosDelivery::bestEffort) dds_qset_history(qos.get(), DDS_HISTORY_KEEP_ALL, 0);
    return qos;
  }
  Topic<T> topic_;
  Reader<T> reader_;
};

}  // namespace

TEST_CASE("a PoseStamped has the bytes that ROS gives it") {
  char frame[] = "ab";
  RosPoseStamped pose{};
  pose.header = {.stamp = {.sec = 7, .nanosec = 8}, .frame_id = frame};
  pose.pose = {.position = {.x = 1, .y = 2, .z = -1}, .orientation = {.x = 0, .y = 0, .z = 0.5, .w = 1}};
  CHECK(wireOf(pose) == withoutSpaces("00010000 07000000 08000000 03000000 616200 00 "
                                      "000000000000f03f 0000000000000040 000000000000f0bf "
                                      "0000000000000000 0000000000000000 000000000000e03f 000000000000f03f"));
}

TEST_CASE("a WrenchStamped has the bytes that ROS gives it") {
  char frame[] = "";
  RosWrenchStamped wrench{};
  wrench.header = {.stamp = {.sec = -1, .nanosec = 256}, .frame_id = frame};
  wrench.wrench = {.force = {.x = 1, .y = 0, .z = 0}, .torque = {.x = 0, .y = 2, .z = -1}};
  CHECK(wireOf(wrench) == withoutSpaces("00010000 ffffffff 00010000 01000000 00 000000 "
                                        "000000000000f03f 0000000000000000 0000000000000000 "
                                        "0000000000000000 0000000000000040 000000000000f0bf"));
}

TEST_CASE("a PointCloud2 has the bytes that ROS gives it") {
  char frame[] = "map";
  RosPointField field{.name = text, .offset = 0, .datatype = 7, .count = 1};
  std::array<std::uint8_t, 8> data{1, 2, 3, 4, 5, 6, 7, 8};
  RosPointCloud2 cloud{};
  cloud.header = {.stamp = {.sec = 1, .nanosec = 2}, .frame_id = frame};
  cloud.height = 1;
  cloud.width = 2;
  give(cloud.fields, std::span(&field, 1));
  cloud.point_step = 4;
  cloud.row_step = 8;
  give(cloud.data, data);
  cloud.is_dense = true;
  // Three bytes pad the last one to a multiple of four, as the encapsulation states.
  CHECK(wireOf(cloud) == withoutSpaces("00010003 01000000 02000000 04000000 6d617000 01000000 02000000 "
                                       "01000000 02000000 7800 0000 00000000 07 000000 01000000 "
                                       "00 000000 04000000 08000000 08000000 0102030405060708 01 000000"));
}

TEST_CASE("an Image has the bytes that ROS gives it") {
  char frame[] = "c", encoding[] = "16UC1";
  std::array<std::uint8_t, 4> data{9, 8, 7, 6};
  RosImage image{};
  image.header = {.stamp = {.sec = 3, .nanosec = 4}, .frame_id = frame};
  image.height = 1;
  image.width = 2;
  image.encoding = encoding;
  image.step = 4;
  give(image.data, data);
  CHECK(wireOf(image) == withoutSpaces("00010000 03000000 04000000 02000000 6300 0000 01000000 02000000 "
                                       "06000000 313655433100 00 00 04000000 04000000 09080706"));
}

TEST_CASE("a TFMessage has the bytes that ROS gives it") {
  char parent[] = "a", child[] = "bc";
  geometry_msgs_msg_dds__TransformStamped_ transform{};
  transform.header = {.stamp = {.sec = 5, .nanosec = 6}, .frame_id = parent};
  transform.child_frame_id = child;
  transform.transform = {.translation = {.x = 1, .y = 2, .z = -1}, .rotation = {.x = 0, .y = 0.5, .z = 0, .w = 1}};
  RosTFMessage message{};
  give(message.transforms, std::span(&transform, 1));
  CHECK(wireOf(message) ==
        withoutSpaces("00010000 01000000 05000000 06000000 02000000 6100 0000 03000000 626300 00 00000000 "
                      "000000000000f03f 0000000000000040 000000000000f0bf "
                      "0000000000000000 000000000000e03f 0000000000000000 000000000000f03f"));
}

TEST_CASE("writers are discovered with ROS's type names, type hashes and enclave") {
  const Participant other(ownNetwork());
  const RosHand hand({.network = ownNetwork(), .name = "/lab/hand"}, 100);
  const RosCloud cloud({.network = ownNetwork(), .name = "lab", .parent = "map"});
  const auto writes = [&](const std::string& topic, const std::string& type, const std::string& hash) {
    CAPTURE(topic);
    const DiscoveredWriter found = discoveredWriter(other, topic);
    CHECK(found.type == type);
    CHECK(found.userData == "typehash=" + hash + ";");
  };
  const std::string pose = "RIHS01_10f3786d7d40fd2b54367835614bff85d4ad3b5dab62bf8bca0cc232d73b4cd8";
  writes("rt/lab/hand/pose", "geometry_msgs::msg::dds_::PoseStamped_", pose);
  writes("rt/lab/hand/proxy", "geometry_msgs::msg::dds_::PoseStamped_", pose);
  writes("rt/lab/hand/wrench", "geometry_msgs::msg::dds_::WrenchStamped_",
         "RIHS01_8dc3deaf06b2ab281f9f9a742a8961c328ca7cec16e3fd6586d3a5c83fa78f77");
  const std::string tf = "RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087";
  writes("rt/tf", "tf2_msgs::msg::dds_::TFMessage_", tf);
  writes("rt/tf_static", "tf2_msgs::msg::dds_::TFMessage_", tf);
  writes("rt/lab/cloud", "sensor_msgs::msg::dds_::PointCloud2_",
         "RIHS01_9198cabf7da3796ae6fe19c4cb3bdd3525492988c70522628af5daa124bae2b5");
  const Reader<dds_builtintopic_participant_t> reader(other, DDS_BUILTIN_TOPIC_DCPSPARTICIPANT);
  int enclaves = 0;
  CHECK(within(5, [&] {
    reader.take([&](const dds_builtintopic_participant_t& seen) { enclaves += userDataOf(seen.qos) == "enclave=/;"; });
    return enclaves == 2;
  }));
}

TEST_CASE("invalid ROS names are refused") {
  CHECK(rosName("/camera/points_2") == "camera/points_2");
  for (const char* name : {"", "/", "a//b", "a/", "//a", "2a", "a/2b", "a b", "a-b", "a__b", "a.b", "\xc3\xa4"}) {
    CAPTURE(name);
    CHECK_THROWS_AS(rosName(name), UsageError);
  }
  CHECK_THROWS_AS(rosName(std::string(201, 'a')), UsageError);
}

TEST_CASE("a hand is published in metres, newtons and newton metres, at the requested rate") {
  const Participant participant = rosParticipant(ownNetwork());
  const AllOf<RosPoseStamped> pose(participant, "rt/hand/pose"), proxy(participant, "rt/hand/proxy"),
      sensor(participant, "rt/hand/pose", RosDelivery::bestEffort);
  const AllOf<RosWrenchStamped> wrench(participant, "rt/hand/wrench");
  RosHand hand({.network = ownNetwork(), .name = "hand", .mm_per_unit = 2}, 100);
  REQUIRE(within(5, [&] { return pose.hasWriter() && proxy.hasWriter() && wrench.hasWriter() && sensor.hasWriter(); }));
  for (int tick = 0; tick <= 1000; ++tick)
    hand.ticked({.time_s = 5 + tick * 1e-3,
                 .hip = {10.0 * tick, 0, 3},
                 .proxy = {0, 1, 0},
                 .force_N = {0, 0, -2},
                 .torque_mNm = {500, 0, 0}},
                {.turn = DQuat(0, 0, 1, 0)});
  const RosHand::Counts counts = hand.finish();
  CHECK(counts.ticks == 101);
  CHECK(counts.lost == 0);
  std::vector<double> x, stamps;
  CHECK(pose.take([&](const RosPoseStamped& message) {
    x.push_back(message.pose.position.x);
    stamps.push_back(message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec);
    CHECK(std::string(message.header.frame_id) == "hand");
    CHECK(message.pose.position.z == near(0.006, 1e-6));
    CHECK(message.pose.orientation.y == 1);
    CHECK(message.pose.orientation.w == 0);
  }) == 101);
  CHECK(x[0] == 0);
  CHECK(x[37] == near(37 * 10 * 10 * 2e-3, 1e-6));
  CHECK(stamps.back() - stamps.front() == near(1, 1e-5));
  CHECK(std::abs(stamps.front() - static_cast<double>(std::time(nullptr))) < 60);
  CHECK(proxy.take([](const RosPoseStamped& message) { CHECK(message.pose.position.y == near(0.002, 1e-6)); }) == 101);
  CHECK(wrench.take([](const RosWrenchStamped& message) {
    CHECK(message.wrench.force.z == -2);
    CHECK(message.wrench.torque.x == 0.5);
  }) == 101);
  CHECK(sensor.take([](const RosPoseStamped&) {}) > 0);
}

TEST_CASE("a frame's transform is kept for late readers, and the hand's frame moves with the hand") {
  const Participant participant = rosParticipant(ownNetwork());
  const AllOf<RosTFMessage> frames(participant, "rt/tf");
  RosHand hand({.network = ownNetwork(),
                .name = "lab/hand1",
                .mm_per_unit = 2,
                .parent = "/map",
                .inParent = {.turn = DQuat(0, 0, 0, 1), .centre = DVec3(1, 2, 3)}},
               100);
  const RosCloud cloud({.network = ownNetwork(), .name = "clay", .parent = "map"});
  const Participant later = rosParticipant(ownNetwork());
  const AllOf<RosTFMessage> stands(later, "rt/tf_static", RosDelivery::latched);
  std::map<std::string, std::string> seen;
  CHECK(within(5, [&] {
    stands.take([&](const RosTFMessage& message) {
      REQUIRE(message.transforms._length == 1);
      const auto& one = message.transforms._buffer[0];
      const auto& [at, turn] = one.transform;
      seen[one.child_frame_id] = fmt::format("{} {:g} {:g} {:g} {:g} {:g} {:g} {:g}", one.header.frame_id, at.x, at.y,
                                             at.z, turn.x, turn.y, turn.z, turn.w);
      CHECK(std::abs(static_cast<double>(one.header.stamp.sec) - static_cast<double>(std::time(nullptr))) < 60);
    });
    return seen.size() == 2;
  }));
  CHECK(seen["lab/hand1"] == "map 1 2 3 0 0 1 0");
  CHECK(seen["clay"] == "map 0 0 0 0 0 0 1");
  REQUIRE(within(5, [&] { return frames.hasWriter(); }));
  for (int tick = 0; tick <= 100; ++tick)
    hand.ticked({.time_s = tick * 1e-3, .hip = {500.0 * tick, 0, 3}}, {.turn = DQuat(0, 0, 1, 0)});
  CHECK(hand.finish().ticks == 11);
  int count = 0;
  CHECK(frames.take([&](const RosTFMessage& message) {
    REQUIRE(message.transforms._length == 1);
    const auto& one = message.transforms._buffer[0];
    CHECK(std::string(one.header.frame_id) == "lab/hand1");
    CHECK(std::string(one.child_frame_id) == "lab/hand1/hand");
    CHECK(one.transform.translation.x == within(10 * count++, 1e-6));
    CHECK(one.transform.translation.z == near(0.006, 1e-6));
    CHECK(one.transform.rotation.y == 1);
  }) == 11);
}

TEST_CASE("invalid frames, and one that is its own parent, are refused") {
  for (const char* parent : {"/", "lab", "/lab", "a\nb"})
    CHECK_THROWS_AS(RosCloud({.network = ownNetwork(), .name = "lab", .parent = parent}), UsageError);
  CHECK_THROWS_AS(requireRosFrame(""), UsageError);
  CHECK_THROWS_AS(requireRosFrame(std::string(257, 'a')), UsageError);
  CHECK_NOTHROW(requireRosFrame("base link-2"));
}

TEST_CASE("a window's camera is published in optical axes and metres, when it moves and twice a second") {
  const Participant participant = rosParticipant(ownNetwork());
  const AllOf<RosPoseStamped> poses(participant, "rt/lab/camera");
  RosCamera camera({.network = ownNetwork(), .name = "lab"});
  REQUIRE(within(5, [&] { return poses.hasWriter(); }));
  CameraPlace place{.position = DVec3(100, 200, 300), .turn = DQuat(0.5, -0.5, 0.5, -0.5), .fovY_rad = 1};
  std::size_t heard = 0;
  const auto hear = [&] {
    heard += poses.take([&](const RosPoseStamped& pose) {
      CHECK(std::string(pose.header.frame_id) == "lab");
      CHECK(pose.pose.position.z == near(0.6, 1e-6));
      CHECK(pose.pose.orientation.w == 0.5);
      CHECK(pose.pose.orientation.x == -0.5);
    });
    return heard;
  };
  for (const Stopwatch since; since.elapsed_s() < 1.2;) {
    camera.show(place, 2);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  CHECK(within(5, [&] { return hear() >= 2; }));
  CHECK(heard <= 3);
  for (const Stopwatch since; since.elapsed_s() < 1;) {
    place.position.x += 1;
    camera.show(place, 2);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  CHECK(within(5, [&] { return hear() > 8; }));
  CHECK(heard <= 34);
}

TEST_CASE("a late reader receives a cloud in its current state") {
  PointCloud cloud;
  for (int i = 0; i < 3000; ++i) {
    cloud.positions.emplace_back(std::sin(i) * 40, std::cos(i) * 40, 0.001 * i);
    cloud.normals.push_back(glm::normalize(Vec3(std::sin(i), std::cos(i), 0)));
  }
  std::vector<PointState> points = statesOf(cloud);
  RosCloud shown({.network = ownNetwork(), .name = "clay", .mm_per_unit = 5});
  CHECK(shown.show(points, {}));
  const RosListening listening{.network = ownNetwork()};
  const PointCloud first = hearRosCloud("clay/cloud", listening);
  CHECK(hearRosCloud("clay/cloud", listening).positions == first.positions);  // a late reader gets it, too
  REQUIRE(first.size() == 3000);
  CHECK(glm::distance(DVec3(first.positions[1000]), DVec3(cloud.positions[1000]) * 0.005) < 1e-6);
  CHECK(glm::distance(first.normals[1000], cloud.normals[1000]) < 1e-6f);
  CHECK(scaleSaidIn(first.storedAs.comments) == 1000);
  points[0].gone = true;
  CHECK(within(5, [&] { return shown.show(points, {}); }));
  CHECK(within(5, [&] { return shown.show(points, {}); }));
  CHECK(shown.shown() == 2);
  CHECK(hearRosCloud("/clay/cloud", listening).size() == 2999);
}

TEST_CASE("a cloud of a million points is one message") {
  std::vector<PointState> points(1'000'000);
  for (std::uint32_t i = 0; i < points.size(); ++i)
    points[i] = {.position = Vec3(i, 0, 1), .number = i, .normal = {0, 0, 1}};
  RosCloud shown({.network = ownNetwork(), .name = "many", .mm_per_unit = 1000});
  CHECK(shown.show(points, {}));
  const PointCloud heard = hearRosCloud("many/cloud", {.network = ownNetwork()});
  REQUIRE(heard.size() == points.size());
  CHECK(heard.positions.back() == Vec3(999'999, 0, 1));
}

TEST_CASE("missing and invalid clouds are reported") {
  const auto fault = [](const std::string& topic) {
    return errorOf([&] { hearRosCloud(topic, {.network = ownNetwork(), .timeout_s = 0.5}); });
  };
  CHECK(says(fault("nothing"), "no PointCloud2 was received in 0.5 s"));
  CHECK(says(fault("no name"), "is not a valid name"));
  const Participant participant = rosParticipant(ownNetwork());
  const RosPublisher<RosPointCloud2> foreign(participant, "rt/foreign", RosDelivery::latched);
  RosPointCloud2 cloud{};
  cloud.header.frame_id = text;
  cloud.height = cloud.width = cloud.row_step = 1000;
  RosPointField field{.name = text, .offset = 0xfffffff0u, .datatype = 7, .count = 0xffffffffu};
  give(cloud.fields, std::span(&field, 1));
  CHECK(foreign.write(cloud));
  CHECK(says(fault("foreign"), "contradicts itself"));
}

}  // namespace palpate::ros_messages_test
