// Live ROS cameras, through the program: felt, drawn, shown in the window, and made into a map.
#include "haptics/sharing/ros_tf.hpp"
#include "tests/apps/ros_touching.hpp"
#include "tests/apps/window_play.hpp"
#include "tests/labels.hpp"
#include "tests/near.hpp"

namespace palpate::ros_frames_test {

using namespace sharing;

namespace {

/// Largest deviation of the force from stiffness times depth along `out`.
double worst_N(const std::vector<Row>& rows, const DVec3& out, const std::function<double(const Row&)>& depth_mm) {
  double worst = 0;
  for (const Row& row : rows)
    worst = std::max(worst, glm::distance(row.force, kStiffness_N_per_mm * depth_mm(row) * out));
  return worst;
}

}  // namespace

TEST_CASE("a plane before a ROS depth camera is felt at its position, in either encoding, and drawn" * kClock) {
  const DVec3 out = glm::normalize(DVec3(0.15, -0.1, -1));
  const double away_m = -glm::dot(out, DVec3(0, 0, 0.5));
  for (const bool isWhole : {false, true}) {
    CAPTURE(isWhole);
    const ScratchFolder folder;
    const SendingCamera camera(network(), "camera/depth", infoOf(kCamera), [&](int) {
      // In millimetres only a plane at a whole number is exact.
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

TEST_CASE("points of a ROS camera have the colours of the named topic") {
  const ScratchFolder folder;
  const SendingCamera camera(network(), "dyed/depth", infoOf(kCamera),
                             [](int) { return pictureOf(kCamera, [](const DVec3&) { return 0.5; }); });
  const Participant participant = rosParticipant(network());
  const RosPublisher<RosImage> colors(participant, "rt/dyed/color", RosDelivery::bestEffort);
  const Sending sending([&](int, std::int64_t stamp_ns) {
    SentPicture color{.encoding = "rgb8", .width = kCamera.width, .height = kCamera.height, .stamp_ns = stamp_ns};
    for (int i = 0; i < 64 * 48; ++i) color.data.insert(color.data.end(), {230, 20, 10});
    colors.write(color.message());
  });
  const std::string picture = (folder / "p.png").string();
  const auto redOf = [&](const std::string& options) {
    works("render ros:dyed/depth/image_raw --color rgb --size 160x120 -o " + picture + options +
          fmt::format(" --domain {}", network().domain));
    const Picture drawn(picture);
    int red = 0;
    for (std::size_t i = 0; i < drawn.rgb.size(); i += 3)
      red += drawn.rgb[i] > 60 && drawn.rgb[i] > 3 * drawn.rgb[i + 1];
    return red;
  };
  CHECK(redOf(" --color-topic /dyed/color") > 2000);
  CHECK(redOf("") == 0);
}

TEST_CASE("a ROS camera is felt in the requested frame, and a cloud is converted into it" * kClock) {
  const ScratchFolder folder;
  const SendingCamera camera(network(), "placed/depth", infoOf(kCamera),
                             [](int) { return pictureOf(kCamera, [](const DVec3&) { return 0.5; }); });
  const Participant participant = rosParticipant(network());
  // The camera is 2 m up in the map and looks down.
  RosTransformPublisher base(participant, "map", "base", true), hangs(participant, "base", "camera", true);
  base.write(0, {1, 0, 0}, DQuat(1, 0, 0, 0));
  hangs.write(0, {0, 0, 2}, DQuat(0, 1, 0, 0));
  const RosPublisher<RosPointCloud2> still(participant, "rt/placed/cloud", RosDelivery::latched);
  pointsOf(kCamera, [](const DVec3&) { return 0.5; }).write(still);
  const DVec3 hip(1.01, 0.02, 1.497);
  std::ofstream(folder / "path.csv") << "t_s,x,y,z\n0,1.01,0.02,1.6\n0.3,1.01,0.02,1.497\n1,1.01,0.02,1.497\n";
  works(fmt::format(
      "touch ros:/placed/depth/image_raw --ros-frame map --realtime --backend cpu --stiffness {} --path {} --trace {} "
      "--json {} --domain {}",
      kStiffness_N_per_mm, (folder / "path.csv").string(), (folder / "t.csv").string(), (folder / "r.json").string(),
      network().domain));
  const std::vector<Row> rows = between(readTrace(folder / "t.csv"), 0.6, 2);
  CHECK(rows.size() > 300);
  CHECK(worst_N(rows, DVec3(0, 0, 1), [](const Row&) { return 3.0; }) < 0.02);
  CHECK(jsonOf(folder / "r.json")["frames"]["lost"] == 0);
  works("convert ros:placed/cloud " + (folder / "c.ply").string() +
        fmt::format(" --ros-frame map --domain {}", network().domain));
  works("info " + (folder / "c.ply").string() + " --json " + (folder / "i.json").string());
  const Result info = jsonOf(folder / "i.json");
  INFO(info.dump());
  CHECK(info["points"] == 64 * 48);
  CHECK(info["up"] == "z");
  CHECK(info["bounds"]["min"][2].get<double>() == near(1.5, 1e-6));
  CHECK(info["bounds"]["max"][2].get<double>() == near(1.5, 1e-6));
  checkEnds(1,
            fmt::format("convert ros:placed/cloud {} --ros-frame mars --domain {}", (folder / "m.ply").string(),
                        network().domain),
            {"no transform on /tf_static and /tf leads to 'mars'"});
}

TEST_CASE("ROS depth images are fused into a saved map, and are shown in the window as they arrive" * kClock) {
  const ScratchFolder folder;
  // Slopes in all directions, since a camera that could slide along its view is not tracked.
  const SendingCamera camera(network(), "seen/depth", infoOf(kCamera), [](int) {
    return pictureOf(kCamera,
                     [](const DVec3& ray) { return 0.5 + 0.03 * std::sin(20 * ray.x) + 0.03 * std::sin(17 * ray.y); });
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
  const auto seen = playWell(fmt::format("ros:seen/depth/image_raw --size 640x480 --domain {}", network().domain), {},
                             "1 state %/s.json\n1.1 screenshot %/p.png\n1.2 quit\n");
  CHECK(seen->state("s.json")["points"] > 2000);
  CHECK(seen->state("s.json")["pictures_of_model"] > 1);
  CHECK(seen->state("s.json")["save_file"] == "camera.ply");
  CHECK(seen->state("s.json")["mm_per_unit"] == 1000);
  CHECK(Picture(seen->folder / "p.png").width == 640);
}

}  // namespace palpate::ros_frames_test
