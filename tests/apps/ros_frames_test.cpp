// Live sensors of ROS as a user meets them: felt as they are sent, drawn, and gone where they fall silent.
#include <algorithm>

#include "tests/apps/running_program.hpp"
#include "tests/apps/window_play.hpp"
#include "tests/sharing/ros_camera.hpp"

namespace palpate {

using namespace sharing;

namespace {

constexpr DepthCamera kCamera{.width = 64, .height = 48, .fx = 120, .fy = 120, .cx = 31.5, .cy = 23.5};
constexpr double kStiffness_N_per_mm = 0.5;

// A domain that no other test is on at the same time.
NetworkConfig network() { return {.domain = 20 + static_cast<std::uint32_t>(::getpid()) % 80}; }

std::string touching(const std::filesystem::path& folder, const DVec3& hip_m, double duration_s) {
  std::ofstream(folder / "path.csv") << fmt::format("t_s,x,y,z\n0,{0},{1},0.4\n0.3,{0},{1},{2}\n{3},{0},{1},{2}\n", hip_m.x,
                                                    hip_m.y, hip_m.z, duration_s);
  return fmt::format(" --realtime --backend cpu --stiffness {} --path {} --trace {} --json {} --domain {}", kStiffness_N_per_mm,
                     (folder / "path.csv").string(), (folder / "t.csv").string(), (folder / "r.json").string(),
                     network().domain);
}

std::vector<Row> between(const std::vector<Row>& rows, double from_s, double to_s) {
  std::vector<Row> found;
  std::ranges::copy_if(rows, std::back_inserter(found), [&](const Row& row) { return row.t_s >= from_s && row.t_s < to_s; });
  return found;
}

/// Of the force against stiffness times how deep the hand is, and its way out.
double worst_N(const std::vector<Row>& rows, const DVec3& out, const std::function<double(const Row&)>& depth_mm) {
  double worst = 0;
  for (const Row& row : rows) worst = std::max(worst, glm::distance(row.force, kStiffness_N_per_mm * depth_mm(row) * out));
  return worst;
}

}  // namespace

TEST_CASE("a plane that a depth camera of ROS sees is felt where it is, in either encoding, and drawn") {
  const DVec3 out = glm::normalize(DVec3(0.15, -0.1, -1));
  const double away_m = -glm::dot(out, DVec3(0, 0, 0.5));
  for (const bool isWhole : {false, true}) {
    CAPTURE(isWhole);
    const ScratchFolder folder;
    const SendingCamera camera(network(), "camera/depth", infoOf(kCamera), [&](int) {
      // In millimetres only a plane of whole ones is exact.
      if (!isWhole) return pictureOf(kCamera, [&](const DVec3& ray) { return -away_m / glm::dot(out, ray); });
      SentPicture picture{.encoding = "16UC1", .width = kCamera.width, .height = kCamera.height};
      for (int i = 0; i < 64 * 48; ++i) picture.data.insert(picture.data.end(), {500 % 256, 500 / 256});  // mm
      return picture;
    });
    const DVec3 hip(0.01, 0.02, 0.505);
    works("touch ros:/camera/depth/image_raw" + touching(folder.path(), hip, 1));
    const std::vector<Row> rows = between(readTrace(folder / "t.csv"), 0.6, 2);
    CHECK(rows.size() > 300);
    const DVec3 side = isWhole ? DVec3(0, 0, -1) : out;
    const double depth_mm = -1000 * (glm::dot(side, hip) + (isWhole ? 0.5 : away_m));
    CHECK(depth_mm > 1);
    CHECK(worst_N(rows, side, [&](const Row&) { return depth_mm; }) < 0.02);
    const auto report = jsonOf(folder / "r.json");
    CHECK(report["mm_per_unit"] == 1000);
    CHECK(report["frames"]["played"] > 10);
    CHECK(report["frames"]["lost"] == 0);
    if (isWhole) continue;
    const std::string picture = (folder / "p.png").string();
    works("render ros:camera/depth/image_raw --size 160x120 -o " + picture +
          fmt::format(" --domain {}", network().domain));
    CHECK(std::filesystem::file_size(picture) > 500);
  }
}

TEST_CASE("pictures of ROS become a map, which is kept, and are seen in the window as they come") {
  const ScratchFolder folder;
  // Slopes in all directions: a camera that may slide along what it sees is not followed.
  const SendingCamera camera(network(), "seen/depth", infoOf(kCamera), [](int) {
    return pictureOf(kCamera, [](const DVec3& ray) { return 0.5 + 0.03 * std::sin(20 * ray.x) + 0.03 * std::sin(17 * ray.y); });
  });
  const std::string map = (folder / "map.ply").string();
  works("touch ros:/seen/depth/image_raw --fuse on --save " + map + touching(folder.path(), {0, 0, 0.503}, 1));
  INFO(jsonOf(folder / "r.json")["frames"].dump());
  CHECK(jsonOf(folder / "r.json")["frames"]["played"] > 5);
  CHECK(jsonOf(folder / "r.json")["contact_ticks"] > 100);
  works("info " + map + " --json " + (folder / "i.json").string());
  CHECK(jsonOf(folder / "i.json")["points"] > 1500);
  CHECK(jsonOf(folder / "i.json")["up"] == "-y");

  if (!hasDisplay()) return;
  const auto seen = play(fmt::format("ros:seen/depth/image_raw --size 640x480 --domain {}", network().domain),
                         "1 state %/s.json\n1.1 screenshot %/p.png\n1.2 quit\n");
  REQUIRE_MESSAGE(seen->outcome.code == 0, seen->outcome.text);
  CHECK(seen->state("s.json")["points"] > 2000);
  CHECK(seen->state("s.json")["pictures_of_model"] > 1);
  CHECK(seen->state("s.json")["save_file"] == "camera.ply");
  CHECK(seen->state("s.json")["mm_per_unit"] == 1000);
  CHECK(Picture(seen->folder / "p.png").width == 640);
}

TEST_CASE("a ball that a scanner of ROS sees is felt as a ball, where it is by now") {
  const ScratchFolder folder;
  const Participant participant = rosParticipant(network());
  const RosPublisher<RosPointCloud2> scans(participant, "rt/scans", RosDelivery::bestEffort);
  constexpr double kRadius_m = 0.1;
  // Within six frames it comes two millimetres nearer.
  const auto centre_m = [](int frame) { return DVec3(0.01, 0, 0.6 - 1e-3 * std::clamp((frame - 45) / 3.0, 0.0, 2.0)); };
  const Sending sender([&](int frame, std::int64_t stamp_ns) {
    const DVec3 centre = centre_m(frame);
    SentPoints points = pointsOf(kCamera, [&](const DVec3& ray) {
      const double a = glm::dot(ray, ray), b = glm::dot(ray, centre), c = glm::dot(centre, centre) - kRadius_m * kRadius_m;
      const double inner = b * b - a * c;
      return inner > 0 ? (b - std::sqrt(inner)) / a : 0;
    });
    points.stamp_ns = stamp_ns;
    points.write(scans);
  });
  const DVec3 hip = centre_m(0) + DVec3(0.02, 0.01, -0.096 + 0.0025);
  works("touch --live ros:/scans" + touching(folder.path(), hip, 3.2));
  const auto felt_N = [&](const DVec3& centre) { return kStiffness_N_per_mm * 1000 * (kRadius_m - glm::distance(hip, centre)); };
  const std::vector<Row> rows = readTrace(folder / "t.csv");
  const std::vector<Row> late = between(rows, 2.8, 3.2);
  REQUIRE(late.size() > 100);
  const DVec3 out = glm::normalize(hip - centre_m(1000));
  const double expected_N = felt_N(centre_m(1000));
  CHECK(expected_N > 1);
  // Normals are those of pixels: a twentieth of what is felt, at the most.
  for (const Row& row : late) {
    CHECK(glm::length(row.force) == doctest::Approx(expected_N).epsilon(0.05));
    CHECK(glm::dot(glm::normalize(row.force), out) > 0.998);
  }
  CHECK(jsonOf(folder / "r.json")["frames"]["lost"] == 0);
  // It comes by a third of a millimetre in each frame, which would be a leap of 0.17 N.
  const std::vector<Row> touched = between(rows, 0.5, 3.2);
  double most_N = 0;
  for (std::size_t i = 1; i < touched.size(); ++i)
    if (touched[i].t_s - touched[i - 1].t_s < 0.002)
      most_N = std::max(most_N, glm::distance(touched[i].force, touched[i - 1].force));
  CHECK(most_N < 0.08);
}

TEST_CASE("a camera of ROS that sends nothing any more but lies is said, and after three seconds nothing is felt") {
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
  CHECK(most_N == doctest::Approx(2).epsilon(0.02));
  for (const Row& row : between(rows, 5.6, 6)) CHECK(row.force == DVec3(0));
  CHECK_FALSE(rows.back().contact);
  const auto frames = jsonOf(folder / "r.json")["frames"];
  CHECK(frames["lost"] > 50);
  CHECK(frames["last_loss"].get<std::string>().find("4000000 x 48 pixels has come, and the camera has 64 x 48") !=
        std::string::npos);
  CHECK_FALSE(frames["silent_since_s"].is_null());
}

TEST_CASE("topics of ROS that are no live camera, and options that do not go with them, are refused in words") {
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
  refuses("touch ros:/pose --realtime", 1, "what is sent there is geometry_msgs/msg/PoseStamped");
  refuses("touch ros:/depth/image_raw", 2, "--realtime: what is live goes by the clock; turn it on");
  refuses("touch --live ros:/points --realtime --fuse on", 1, "what is sent there are points");
  refuses("touch ros:/points --loop", 2, "is no recorded depth camera");
  refuses("convert ros:/depth/image_raw never.ply", 1, "what is sent there is sensor_msgs/msg/Image");
  refuses("touch --live ros:/a//b --realtime", 2, "is no name there");
}

}  // namespace palpate
