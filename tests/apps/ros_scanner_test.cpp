// ROS scanners and cameras that move, fall silent, send invalid data, or do not exist, through the program.
#include "tests/apps/ros_touching.hpp"
#include "tests/labels.hpp"
#include "tests/near.hpp"

namespace palpate::ros_scanner_test {

using namespace sharing;

TEST_CASE("a ball before a ROS scanner is felt as a ball, at its current position" * kClock) {
  const ScratchFolder folder;
  const Participant participant = rosParticipant(network());
  const RosPublisher<RosPointCloud2> scans(participant, "rt/scans", RosDelivery::bestEffort);
  constexpr double kRadius_m = 0.1;
  // Within six frames it approaches by two millimetres.
  const auto centre_m = [](int frame) { return DVec3(0.01, 0, 0.6 - 1e-3 * std::clamp((frame - 45) / 3.0, 0.0, 2.0)); };
  const Sending sender([&](int frame, std::int64_t stamp_ns) {
    const DVec3 centre = centre_m(frame);
    SentPoints points = pointsOf(kCamera, [&](const DVec3& ray) {
      const double a = glm::dot(ray, ray), b = glm::dot(ray, centre),
                   c = glm::dot(centre, centre) - kRadius_m * kRadius_m;
      const double inner = b * b - a * c;
      return inner > 0 ? (b - std::sqrt(inner)) / a : 0;
    });
    points.stamp_ns = stamp_ns;
    points.write(scans);
  });
  const DVec3 hip = centre_m(0) + DVec3(0.02, 0.01, -0.096 + 0.0025);
  works("touch --live ros:/scans" + touching(folder.path(), hip, 3.2));
  const auto felt_N = [&](const DVec3& centre) {
    return kStiffness_N_per_mm * 1000 * (kRadius_m - glm::distance(hip, centre));
  };
  const std::vector<Row> rows = readTrace(folder / "t.csv");
  const std::vector<Row> late = between(rows, 2.8, 3.2);
  REQUIRE(late.size() > 100);
  const DVec3 out = glm::normalize(hip - centre_m(1000));
  const double expected_N = felt_N(centre_m(1000));
  CHECK(expected_N > 1);
  // Normals are computed from pixels: at most a twentieth of error in the force.
  for (const Row& row : late) {
    CHECK(glm::length(row.force) == near(expected_N, 0.05));
    CHECK(glm::dot(glm::normalize(row.force), out) > 0.998);
  }
  CHECK(jsonOf(folder / "r.json")["frames"]["lost"] == 0);
  // It approaches by a third of a millimetre per frame, which without interpolation would be a step of 0.17 N.
  const std::vector<Row> touched = between(rows, 0.5, 3.2);
  double most_N = 0;
  for (std::size_t i = 1; i < touched.size(); ++i)
    if (touched[i].t_s - touched[i - 1].t_s < 0.002)
      most_N = std::max(most_N, glm::distance(touched[i].force, touched[i - 1].force));
  CHECK(most_N < 0.08);
}

TEST_CASE("a ROS camera that sends only invalid images is reported, and its force stops after three seconds" * kClock) {
  const ScratchFolder folder;
  const SendingCamera camera(network(), "failing/depth", infoOf(kCamera), [&](int frame) {
    SentPicture picture = pictureOf(kCamera, [](const DVec3&) { return 0.5; });
    if (frame > 60) picture.width = 4'000'000;
    return picture;
  });
  works("touch ros:/failing/depth/image_raw" + touching(folder.path(), {0, 0, 0.504}, 5.8));
  const std::vector<Row> rows = readTrace(folder / "t.csv");
  double most_N = 0;
  for (const Row& row : between(rows, 0.4, 1)) most_N = std::max(most_N, glm::length(row.force));
  CHECK(most_N == near(2, 0.02));
  for (const Row& row : between(rows, 5.6, 6)) CHECK(row.force == DVec3(0));
  CHECK_FALSE(rows.back().contact);
  const auto frames = jsonOf(folder / "r.json")["frames"];
  CHECK(frames["lost"] > 50);
  CHECK(frames["last_loss"].get<std::string>().find("4000000 x 48 pixels, and the camera has 64 x 48") !=
        std::string::npos);
  CHECK_FALSE(frames["silent_since_s"].is_null());
}

TEST_CASE("ROS topics that are not a live camera, and incompatible options, are refused with a reason") {
  const Participant participant = rosParticipant(network());
  const RosPublisher<RosPoseStamped> pose(participant, "rt/pose", RosDelivery::reliable);
  const RosPublisher<RosPointCloud2> points(participant, "rt/points", RosDelivery::reliable);
  const RosPublisher<RosImage> pictures(participant, "rt/depth/image_raw", RosDelivery::reliable);
  const auto refuses = [&](const std::string& arguments, int code, const std::string& words) {
    const Outcome outcome = palpate(arguments + fmt::format(" --domain {}", network().domain));
    CAPTURE(outcome.text);
    CHECK(outcome.code == code);
    CHECK(outcome.text.find(words) != std::string::npos);
  };
  refuses("touch ros:/pose --realtime", 1, "the topic has type geometry_msgs/msg/PoseStamped");
  refuses("touch ros:/depth/image_raw", 2, "--realtime: live streams require realtime");
  refuses("touch --live ros:/points --realtime --fuse on", 1, "the topic has points");
  refuses("touch ros:/points --loop", 2, "is not a recorded depth camera");
  refuses("convert ros:/depth/image_raw never.ply", 1, "the topic has type sensor_msgs/msg/Image");
  refuses("touch --live ros:/a//b --realtime", 2, "is not a valid name");
}

}  // namespace palpate::ros_scanner_test
