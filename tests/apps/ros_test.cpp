// Hands and clouds for ROS 2 programs, through the program: received here by readers of ROS's own types.
#include "haptics/sharing/ros_messages.hpp"

#include <algorithm>

#include "tests/apps/running_program.hpp"
#include "tests/own_domain.hpp"
#include "tests/sharing/ros_discovery.hpp"

namespace palpate::ros_test {

using namespace sharing;

namespace {

// A domain that no other test uses at the same time.
NetworkConfig network() { return {.domain = ownDomain()}; }
std::string domain() { return " --domain " + std::to_string(network().domain); }

bool isNear(const geometry_msgs_msg_dds__Point_& heard_m, const DVec3& place, double mm_per_unit) {
  return glm::distance(DVec3(heard_m.x, heard_m.y, heard_m.z), place * (mm_per_unit * 1e-3)) < 1e-9;
}

}  // namespace

TEST_CASE("ROS readers receive a hand tick by tick as in its trace") {
  const ScratchFolder folder;
  const auto in = [&](const char* name) { return (folder / name).string(); };
  works("make sphere -n 5000 -o " + in("m.ply"));
  const Participant participant = rosParticipant(network());
  const RosType poseType = rosTypeOf<RosPoseStamped>(), wrenchType = rosTypeOf<RosWrenchStamped>();
  const Topic<RosPoseStamped> poses(participant, poseType.descriptor, "rt/lab/pose"),
      proxies(participant, poseType.descriptor, "rt/lab/proxy");
  const Topic<RosWrenchStamped> wrenches(participant, wrenchType.descriptor, "rt/lab/wrench");
  Qos all = rosQos(RosDelivery::reliable, poseType);
  dds_qset_history(all.get(), DDS_HISTORY_KEEP_ALL, 0);
  const Reader<RosPoseStamped> pose(participant, poses, all), proxy(participant, proxies, all);
  const Reader<RosWrenchStamped> wrench(participant, wrenches, all);
  const Topic<RosTFMessage> moving(participant, rosTypeOf<RosTFMessage>().descriptor, "rt/tf"),
      fixed(participant, rosTypeOf<RosTFMessage>().descriptor, "rt/tf_static");
  const Reader<RosTFMessage> transforms(participant, moving, all),
      stands(participant, fixed, rosQos(RosDelivery::latched, rosTypeOf<RosTFMessage>()));
  const auto discovered = [&] { return discoveredWriter(participant, "rt/lab/pose", 0.01).userData; };

  RunningProgram hand(
      "touch " + in("m.ply") +
          " --mm-per-unit 20 --backend cpu --realtime --duration 2 --ros lab --ros-rate 50 --ros-parent map "
          "--ros-pose 1,2,3,0,0,0,1" +
          domain() + " --trace " + in("t.csv") + " --json " + in("r.json"),
      folder / "said");
  std::string userData;
  CHECK(hand.waitFor([&] { return !(userData = discovered()).empty(); }));
  CHECK(userData == "typehash=RIHS01_10f3786d7d40fd2b54367835614bff85d4ad3b5dab62bf8bca0cc232d73b4cd8;");
  hand.waitFor([&] { return hand.ended(); });
  CAPTURE(contentOf(folder / "said"));
  const auto frameOf = [](const RosTFMessage& message) {
    REQUIRE(message.transforms._length == 1);
    const auto& one = message.transforms._buffer[0];
    const auto& [at, turn] = one.transform;
    return fmt::format("{} in {} at {:g} {:g} {:g} turned {:g} {:g} {:g} {:g}", one.child_frame_id, one.header.frame_id,
                       at.x, at.y, at.z, turn.x, turn.y, turn.z, turn.w);
  };
  std::size_t hands = 0;
  transforms.take([&](const RosTFMessage& message) { hands += frameOf(message).starts_with("lab/hand in lab at "); });
  CHECK(hands > 20);
  CHECK(hands <= 101);
  std::string where;
  CHECK(stands.take([&](const RosTFMessage& message) { where = frameOf(message); }) == 1);
  CHECK(where == "lab in map at 1 2 3 turned 0 0 1 0");
  CHECK(jsonOf(in("r.json"))["ros"]["ticks"] > 20);
  CHECK(jsonOf(in("r.json"))["ros"]["ticks"] <= 101);
  CHECK(jsonOf(in("r.json"))["ros"]["lost"] == 0);

  const std::vector<Row> rows = readTrace(in("t.csv"));
  // Late discovery misses the first messages, and a busy machine drops ticks; the others are in the trace's order.
  const auto checkAll = [&]<class T>(const Reader<T>& reader, const auto& isRight) {
    std::vector<T> heard;
    std::vector<std::string> frames;
    reader.take([&](const T& message) {
      heard.push_back(message);
      frames.emplace_back(message.header.frame_id);
    });
    CHECK(heard.size() > 20);
    CHECK(heard.size() <= 101);
    std::size_t found = 0;
    for (auto row = rows.begin(); row != rows.end() && found < heard.size(); ++row)
      found += isRight(heard[found], *row);
    CHECK(found == heard.size());
    CHECK(std::ranges::count(frames, "lab") == std::ranges::ssize(heard));
  };
  checkAll(pose,
           [](const RosPoseStamped& message, const Row& row) { return isNear(message.pose.position, row.hip, 20); });
  checkAll(proxy,
           [](const RosPoseStamped& message, const Row& row) { return isNear(message.pose.position, row.proxy, 20); });
  double most_N = 0;
  checkAll(wrench, [&](const RosWrenchStamped& message, const Row& row) {
    const DVec3 force(message.wrench.force.x, message.wrench.force.y, message.wrench.force.z);
    most_N = std::max(most_N, glm::length(force));
    return glm::distance(force, row.force) < 1e-9;
  });
  CHECK(most_N > 0.5);
}

TEST_CASE("a served cloud is read as a ROS model, felt, sculpted, and read again as others have sculpted it") {
  const ScratchFolder folder;
  const auto in = [&](const char* name) { return (folder / name).string(); };
  works("make bumpy-sphere -n 20000 -o " + in("m.ply"));
  RunningProgram serving("serve " + in("m.ply") + " --mm-per-unit 1 --name clay --ros lab" + domain(), folder / "said");
  REQUIRE(serving.waitFor([&] { return contentOf(folder / "said").find("serving") != std::string::npos; }));
  const std::string topic = "ros:/lab/cloud" + domain();
  works("convert ros:lab/cloud " + in("before.ply") + domain());
  CHECK(contentOf(in("before.ply")).find("comment mm_per_unit: 1000") != std::string::npos);
  works("touch " + topic + " --backend cpu --duration 0.4 --path builtin:slide --edit push --save " + in("own.ply") +
        " --json " + in("r.json"));
  const Result felt = jsonOf(in("r.json"));
  CHECK(felt["points"] == 20000);
  CHECK(felt["mm_per_unit"] == 1000);
  CHECK(felt["contact_ticks"] > 50);
  CHECK(felt["moved_points"] > 20);
  works("touch --join clay" + domain() + " --backend cpu --duration 0.4 --path builtin:slide --edit push");
  // An edit is received within little more than a second.
  CHECK(within(10, [&] {
    works("convert ros:lab/cloud " + in("after.ply") + " --force" + domain());
    return contentOf(in("after.ply")) != contentOf(in("before.ply"));
  }));
  CHECK(serving.wait(SIGINT) == 0);
}

TEST_CASE("invalid ROS names, and ROS options without ROS, are refused") {
  const auto refuses = [](const std::string& arguments, const std::string& words) {
    const Outcome outcome = palpate(arguments);
    CAPTURE(outcome.text);
    CHECK(outcome.code == 2);
    CHECK(outcome.text.find(words) != std::string::npos);
  };
  refuses("touch a.ply --ros 2nd", "is not a valid name");
  refuses("serve a.ply --name a --ros a-b", "is not a valid name");
  refuses("touch ros:a//b", "is not a valid name");
  refuses("touch a.ply --ros-rate 0 --ros a", "--ros-rate");
  refuses("touch a.ply --ros lab --ros-parent lab", "cannot be its own parent");
  refuses("touch a.ply --ros-parent map", "--ros-parent: requires --ros");
  refuses("touch a.ply --ros lab --ros-pose 1,2,3", "--ros-pose: requires --ros-parent");
  for (const char* pose : {"1,2", "1,2,3,4", "1,2,x", "1,2,nan", "0,0,0,1,1,0,0", "0,0,0,0,0,0,0", "1e10,0,0"})
    refuses(std::string("serve a.ply --name a --ros lab --ros-parent map --ros-pose ") + pose, "unit quaternion");
  refuses("touch a.ply --ros-frame map", "--ros-frame and --color-topic: require a ROS topic");
  refuses("serve a.ply --name a --ros-frame map", "--ros-frame and --color-topic: require a ROS topic");
  refuses("convert a.ply b.ply --ros-frame map", "--ros-frame and --color-topic: require a ROS topic");
  refuses("view a.ply --color-topic rgb", "--ros-frame and --color-topic: require a ROS topic");
  refuses("touch ros:a --color-topic a//b", "is not a valid name");
  refuses("touch ros:a --ros-frame /", "is not a valid name of a frame");
  refuses("touch a.ply --domain 3", "require --join, --ros or a ROS topic");
  CHECK(palpate("mesh ros:a -o never.ply").text.find("are not supported here") != std::string::npos);
}

}  // namespace palpate::ros_test
