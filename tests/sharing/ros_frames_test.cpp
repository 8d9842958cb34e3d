// Topics of ROS as frames, on the network of this machine: pictures with their camera, points with and without rows, and
// what is none of that.
#include <doctest/doctest.h>

#include <atomic>
#include <functional>

#include "haptics/sharing/ros.hpp"
#include "tests/sharing/own_network.hpp"
#include "tests/sharing/ros_camera.hpp"
#include "tests/sharing/ros_discovery.hpp"

namespace palpate {

using namespace sharing;

namespace {

constexpr DepthCamera kCamera{.width = 32, .height = 24, .fx = 30, .fy = 30, .cx = 15.5, .cy = 11.5};

RosWatching watching(double patience_s = 10) {
  return {.listening = {.network = ownNetwork(), .patience_s = patience_s}, .threads = 1};
}

std::string refusal(const std::function<void()>& act) {
  try {
    act();
  } catch (const Error& error) {
    return error.what();
  }
  return "nothing is refused";
}

bool says(const std::string& text, const std::string& words) {
  INFO(text);
  const bool said = text.find(words) != std::string::npos;
  CHECK(said);
  return said;
}

double flat(const DVec3&) { return 2; }

/// Frames that can be read, until `isEnough`, and why others could not.
struct Read {
  std::vector<DepthFrame> frames;
  std::vector<std::string> losses;
};
Read readUntil(DepthStream& stream, const std::function<bool(const Read&)>& isEnough) {
  Read read;
  const Stopwatch since;
  while (!isEnough(read) && since.elapsed_s() < 10) {
    DepthFrame frame;
    try {
      if (!stream.next(frame)) break;
      read.frames.push_back(frame);
    } catch (const Error& error) {
      read.losses.emplace_back(error.what());
    }
  }
  return read;
}

}  // namespace

TEST_CASE("pictures of depth come once each, in order, with the camera that is said beside them") {
  const SendingCamera sender(ownNetwork(), "lab/depth", infoOf(kCamera), [](int frame) {
    return pictureOf(kCamera, [&](const DVec3&) { return 1 + 0.001 * frame; });
  });
  CHECK(whatRosSends("/lab/depth/image_raw", watching().listening) == RosContent::pictures);
  const auto stream = watchRosFrames("/lab/depth/image_raw", watching());
  CHECK(stream->camera() == kCamera);
  CHECK_FALSE(stream->isRecorded());
  const Read read = readUntil(*stream, [](const Read& r) { return r.frames.size() == 10; });
  CHECK(read.losses.empty());
  REQUIRE(read.frames.size() == 10);
  for (std::size_t i = 1; i < 10; ++i) {
    const DepthFrame &frame = read.frames[i], &before = read.frames[i - 1];
    REQUIRE(frame.depth_m.size() == 32 * 24);
    CHECK(frame.number == before.number + 1);
    CHECK(frame.depth_m[5] > before.depth_m[5]);
    CHECK(frame.time_s > before.time_s);
    CHECK_FALSE(frame.points.has_value());
  }
  // A millimetre in each frame, of 33 ms.
  const double way_m = read.frames[9].depth_m[5] - read.frames[0].depth_m[5];
  CHECK(read.frames[9].time_s - read.frames[0].time_s == doctest::Approx(33 * way_m).epsilon(0.2));
  stream->stop();
  DepthFrame frame;
  CHECK_FALSE(stream->next(frame));
}

TEST_CASE("a camera that is given needs none beside the pictures, and without either that is said") {
  const SendingCamera sender(ownNetwork(), "bare/depth", RosCameraInfo{.header = {.stamp = {}, .frame_id = nullptr}},
                             [](int) { return pictureOf(kCamera, flat); });
  CHECK(says(refusal([&] { watchRosFrames("bare/depth/image_raw", watching()); }), "a CameraInfo is of 0 x 0 pixels"));
  RosWatching given = watching();
  given.camera = kCamera;
  given.depthScale = 4;
  const auto stream = watchRosFrames("bare/depth/image_raw", given);
  DepthFrame frame;
  REQUIRE(stream->next(frame));
  CHECK(frame.depth_m[0] == 0.5f);

  const Participant participant = rosParticipant(ownNetwork());
  const RosPublisher<RosImage> alone(participant, "rt/alone/image_raw", RosDelivery::latched);
  SentPicture picture = pictureOf(kCamera, flat);
  CHECK(alone.write(picture.message()));
  CHECK(says(refusal([&] { watchRosFrames("alone/image_raw", watching(0.5)); }),
             "no CameraInfo has come on alone/camera_info in 0.5 s"));
}

TEST_CASE("pictures that lie, or are of another size, encoding or frame, are lost one by one in words") {
  const SendingCamera sender(ownNetwork(), "lies/depth", infoOf(kCamera), [](int frame) {
    SentPicture picture = pictureOf(kCamera, flat);
    if (frame % 6 == 1) picture = pictureOf({.width = 16, .height = 12, .fx = 1, .fy = 1, .cx = 0, .cy = 0}, flat);
    if (frame % 6 == 2) picture.encoding = "rgb8";
    if (frame % 6 == 3) picture.data.clear();
    if (frame % 6 == 4) picture.frame = "elsewhere";
    return picture;
  });
  const auto stream = watchRosFrames("lies/depth/image_raw", watching());
  const Read read = readUntil(*stream, [](const Read& r) { return r.losses.size() == 8; });
  CHECK(read.frames.size() >= 3);
  std::string all;
  for (const std::string& loss : read.losses) all += loss + "\n";
  CHECK(says(all, "of 16 x 12 pixels has come, and the camera has 32 x 24"));
  CHECK(says(all, "and this one is 'rgb8'"));
  CHECK(says(all, "contradicts itself"));
  CHECK(says(all, "is in the frame 'elsewhere', and the first one was in 'camera'"));
  CHECK(says(all, "ros:lies/depth/image_raw: message "));
}

TEST_CASE("points in rows come as frames with normals that face the sensor, and without rows, too") {
  const Participant participant = rosParticipant(ownNetwork());
  // As a driver of a sensor sends them, and as most programs do.
  const RosPublisher<RosPointCloud2> rows(participant, "rt/rows", RosDelivery::bestEffort);
  const RosPublisher<RosPointCloud2> heap(participant, "rt/heap", RosDelivery::latched);
  const DVec3 upright = glm::normalize(DVec3(0.1, 0.2, -1));
  const auto slanted = [&](const DVec3& ray) { return ray.x < -0.4 ? 0 : -1.5 / glm::dot(upright, ray); };
  const Sending sender([&](int, std::int64_t stamp_ns) {
    SentPoints points = pointsOf(kCamera, slanted);
    points.stamp_ns = stamp_ns;
    points.write(rows);
    points.width *= std::exchange(points.height, 1);
    points.write(heap);
  });
  for (const char* topic : {"rows", "heap"}) {
    CAPTURE(topic);
    CHECK(whatRosSends(topic, watching().listening) == RosContent::points);
    const auto stream = watchRosFrames(topic, watching());
    const Read read = readUntil(*stream, [](const Read& r) { return r.frames.size() == 4; });
    REQUIRE(read.frames.size() == 4);
    CHECK(read.losses.empty());
    CHECK(read.frames[3].number == 3);  // each once, by however many ways it could come
    const DepthFrame& frame = read.frames[3];
    REQUIRE(frame.points.has_value());
    CHECK(frame.depth_m.empty());
    const auto expected = static_cast<std::size_t>(
        std::ranges::count_if(pointsOf(kCamera, slanted).places, [](const Vec3& place) { return isFinite(place); }));
    CHECK(expected > 500);
    CHECK(frame.points->places.size() == expected);
    double worst = 0;
    for (std::size_t i = 0; i < expected; ++i) {
      worst = std::max(worst, std::abs(glm::dot(upright, frame.points->places[i]) + 1.5));
      worst = std::max(worst, glm::distance(DVec3(frame.points->normals[i]), upright));
    }
    CHECK(worst < 1e-4);
    const std::size_t room = std::size_t{stream->camera().width} * stream->camera().height;
    CHECK(room == (topic == std::string("rows") ? 32 * 24 : 65'536));
  }
  RosWatching fused = watching();
  fused.needsPictures = true;
  CHECK(says(refusal([&] { watchRosFrames("rows", fused); }), "what is sent there are points"));
}

TEST_CASE("more points than the first message has room for are a lost frame") {
  const Participant participant = rosParticipant(ownNetwork());
  const RosPublisher<RosPointCloud2> growing(participant, "rt/growing", RosDelivery::reliable);
  const DepthCamera large{.width = 64, .height = 48, .fx = 30, .fy = 30, .cx = 31, .cy = 23};
  std::atomic<bool> grows = false;
  const Sending sender([&](int, std::int64_t) { pointsOf(grows ? large : kCamera, flat).write(growing); });
  const auto stream = watchRosFrames("growing", watching());
  CHECK(stream->camera().width == 32 * 24);
  grows = true;
  const Read read = readUntil(*stream, [](const Read& r) { return !r.losses.empty(); });
  REQUIRE(read.losses.size() == 1);
  CHECK(says(read.losses[0], "has 3072 points, and there is room for 768"));
}

TEST_CASE("a topic of something else, and one where nobody sends, is said before a message comes") {
  const Participant participant = rosParticipant(ownNetwork());
  const RosPublisher<RosPoseStamped> pose(participant, "rt/pose", RosDelivery::reliable);
  const std::string words = "what is sent there is geometry_msgs/msg/PoseStamped, and what is heard here is ";
  CHECK(says(refusal([&] { whatRosSends("pose", watching().listening); }),
             words + "sensor_msgs/msg/PointCloud2 or sensor_msgs/msg/Image"));
  CHECK(says(refusal([&] { hearRosCloud("/pose", watching().listening); }), words + "sensor_msgs/msg/PointCloud2"));
  CHECK(says(refusal([&] { watchRosFrames("nobody", watching(0.3)); }), "nobody sends there in 0.3 s"));
  CHECK(says(refusal([&] { watchRosFrames("a//b", watching()); }), "is no name there"));
  const std::atomic<bool> stop = true;
  RosWatching stopped = watching();
  stopped.listening.stop = &stop;
  CHECK(says(refusal([&] { watchRosFrames("nobody", stopped); }), "interrupted"));
}

}  // namespace palpate
