// ROS topics as frames, on the network of this machine: depth images with their camera, points with and without rows,
// and invalid topics.
#include <doctest/doctest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <thread>

#include "haptics/sharing/ros.hpp"
#include "haptics/sharing/ros_tf.hpp"
#include "tests/error_of.hpp"
#include "tests/near.hpp"
#include "tests/says.hpp"
#include "tests/sharing/own_network.hpp"
#include "tests/sharing/ros_camera.hpp"
#include "tests/sharing/ros_discovery.hpp"

namespace palpate::ros_frames_test {

using namespace sharing;

namespace {

constexpr DepthCamera kCamera{.width = 32, .height = 24, .fx = 30, .fy = 30, .cx = 15.5, .cy = 11.5};

RosWatching watching(double timeout_s = 10) {
  return {.listening = {.network = ownNetwork(), .timeout_s = timeout_s}, .threads = 1};
}

double flat(const DVec3&) { return 2; }

/// Whether frames are in order and dropped ones are counted at most once: a reader that was too late drops frames.
bool isLaterAndCountedOnce(const DepthFrame& frame, long sent, const DepthFrame& before, long sentBefore) {
  return sent > sentBefore && frame.number > before.number &&
         frame.number - before.number <= static_cast<std::uint64_t>(sent - sentBefore);
}

/// Frames read until `isEnough`, and the reasons for those lost.
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

TEST_CASE("depth images arrive once each, in order, with the camera of their CameraInfo") {
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
  const auto sentAs = [](const DepthFrame& frame) { return std::lround(1000 * (frame.depth_m[5] - 1)); };
  for (std::size_t i = 1; i < 10; ++i) {
    const DepthFrame &frame = read.frames[i], &before = read.frames[i - 1];
    REQUIRE(frame.depth_m.size() == 32 * 24);
    CHECK(isLaterAndCountedOnce(frame, sentAs(frame), before, sentAs(before)));
    CHECK(frame.time_s > before.time_s);
    CHECK_FALSE(frame.points.has_value());
  }
  // A millimetre per frame of 33 ms.
  const double way_m = read.frames[9].depth_m[5] - read.frames[0].depth_m[5];
  CHECK(read.frames[9].time_s - read.frames[0].time_s == near(33 * way_m, 0.2));
  stream->stop();
  DepthFrame frame;
  CHECK_FALSE(stream->next(frame));
}

TEST_CASE("a given camera replaces the CameraInfo, and an error reports that both are missing") {
  const SendingCamera sender(ownNetwork(), "bare/depth", RosCameraInfo{.header = {.stamp = {}, .frame_id = nullptr}},
                             [](int) { return pictureOf(kCamera, flat); });
  CHECK(says(errorOf([&] { watchRosFrames("bare/depth/image_raw", watching()); }), "a CameraInfo is of 0 x 0 pixels"));
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
  CHECK(says(errorOf([&] { watchRosFrames("alone/image_raw", watching(0.5)); }),
             "no CameraInfo was received on alone/camera_info in 0.5 s"));
}

TEST_CASE("invalid images, and those of another size, encoding or frame, are lost one by one with a reason") {
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
  CHECK(says(all, "has 16 x 12 pixels, and the camera has 32 x 24"));
  CHECK(says(all, "and this one is 'rgb8'"));
  CHECK(says(all, "contradicts itself"));
  CHECK(says(all, "is in the frame 'elsewhere', and the first one was in 'camera'"));
  CHECK(says(all, "ros:lies/depth/image_raw: message "));
}

TEST_CASE("organised and unorganised points arrive as frames with normals that face the sensor") {
  const Participant participant = rosParticipant(ownNetwork());
  // As sensor drivers send them, and as most other programs do.
  const RosPublisher<RosPointCloud2> rows(participant, "rt/rows", RosDelivery::bestEffort);
  const RosPublisher<RosPointCloud2> heap(participant, "rt/heap", RosDelivery::latched);
  const DVec3 upright = glm::normalize(DVec3(0.1, 0.2, -1));
  // A millimetre farther away in each frame.
  const auto slanted = [&](long sent) {
    return [&upright, sent](const DVec3& ray) {
      return ray.x < -0.4 ? 0 : -(1.5 + 0.001 * static_cast<double>(sent)) / glm::dot(upright, ray);
    };
  };
  const auto distanceOf = [&](const Vec3& place) { return -glm::dot(upright, DVec3(place)); };
  const auto sentAs = [&](const DepthFrame& frame) {
    return std::lround(1000 * (distanceOf(frame.points.value().places.at(0)) - 1.5));
  };
  const Sending sender([&](int frame, std::int64_t stamp_ns) {
    SentPoints points = pointsOf(kCamera, slanted(frame));
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
    for (std::size_t i = 1; i < 4; ++i) {
      const DepthFrame &frame = read.frames[i], &before = read.frames[i - 1];
      CHECK(isLaterAndCountedOnce(frame, sentAs(frame), before, sentAs(before)));
    }
    const DepthFrame& frame = read.frames[3];
    REQUIRE(frame.points.has_value());
    const long sent = sentAs(frame);
    CHECK(frame.depth_m.empty());
    const auto expected = static_cast<std::size_t>(std::ranges::count_if(
        pointsOf(kCamera, slanted(sent)).places, [](const Vec3& place) { return isFinite(place); }));
    CHECK(expected > 500);
    CHECK(frame.points->places.size() == expected);
    double worst = 0;
    for (std::size_t i = 0; i < expected; ++i) {
      worst = std::max(worst, std::abs(distanceOf(frame.points->places[i]) - 1.5 - 0.001 * static_cast<double>(sent)));
      worst = std::max(worst, glm::distance(DVec3(frame.points->normals[i]), upright));
    }
    CHECK(worst < 1e-4);
    const std::size_t room = std::size_t{stream->camera().width} * stream->camera().height;
    CHECK(room == (topic == std::string("rows") ? 32 * 24 : 65'536));
  }
  RosWatching fused = watching();
  fused.needsPictures = true;
  CHECK(says(errorOf([&] { watchRosFrames("rows", fused); }), "the topic has points"));
}

TEST_CASE("a message of more points than the first has room for is a lost frame") {
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

TEST_CASE("depth images have the colours of the same time, and are lost without them") {
  const Participant participant = rosParticipant(ownNetwork());
  const RosPublisher<RosImage> depths(participant, "rt/dyed/image_raw", RosDelivery::bestEffort),
      colors(participant, "rt/dyed/color", RosDelivery::bestEffort);
  enum class Sent { both, depthsAlone, larger };
  std::atomic<Sent> sends = Sent::both;
  const Sending sender([&](int frame, std::int64_t stamp_ns) {
    // Both contain the frame's number, so that a colour of another frame is detected; colours are sent shortly after
    // the depths.
    const auto number = static_cast<std::uint8_t>(frame % 200);
    SentPicture picture = pictureOf(kCamera, [&](const DVec3&) { return 1 + 0.001 * number; });
    picture.stamp_ns = stamp_ns;
    depths.write(picture.message());
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    if (sends == Sent::depthsAlone) return;
    const std::uint32_t width = sends == Sent::larger ? 33 : 32;
    SentPicture color{.encoding = "bgr8", .width = width, .height = 24, .stamp_ns = stamp_ns};
    for (std::uint32_t i = 0; i < width * 24; ++i) color.data.insert(color.data.end(), {7, 8, number});
    colors.write(color.message());
  });
  RosWatching dyed = watching();
  dyed.camera = kCamera;
  dyed.colorTopic = "/dyed/color";
  const auto stream = watchRosFrames("dyed/image_raw", dyed);
  const Read read = readUntil(*stream, [](const Read& r) { return r.frames.size() == 10; });
  REQUIRE(read.frames.size() == 10);
  CHECK(read.losses.size() <= 1);  // the first one, whose colours had no reader yet
  for (const DepthFrame& frame : read.frames) {
    REQUIRE(frame.colors.size() == 32 * 24);
    const auto number = static_cast<int>(std::lround(1000 * (frame.depth_m[5] - 1)));
    CHECK(int(frame.colors[5][0]) == number);
    CHECK(int(frame.colors[5][1]) == 8);
    CHECK(int(frame.colors[767][2]) == 7);
  }
  const auto lossOf = [&](Sent what) {
    sends = what;
    readUntil(*stream, [](const Read& r) { return r.losses.size() == 1; });  // pending frames are read first
    const Read lost = readUntil(*stream, [](const Read& r) { return r.losses.size() == 1; });
    return lost.losses.empty() ? std::string() : lost.losses.front();
  };
  CHECK(says(lossOf(Sent::depthsAlone), "has no colour image of its time beside it, on ros:/dyed/color"));
  CHECK(says(lossOf(Sent::larger), "an Image has 33 x 24 pixels, and the camera has 32 x 24"));
  sends = Sent::both;
  CHECK(readUntil(*stream, [](const Read& r) { return r.frames.size() == 3; }).frames.size() == 3);
}

TEST_CASE("sensor data is transformed into the requested frame over static and moving transforms") {
  const Participant participant = rosParticipant(ownNetwork());
  RosTransformPublisher mast(participant, "map", "mast", true), arm(participant, "mast", "arm", false),
      optical(participant, "arm", "camera", true);
  const double half = std::sqrt(0.5);
  // The mast is at x = 10; the arm rises a millimetre per frame; the camera on it looks along x of the map.
  CHECK(mast.write(0, {10, 0, 0}, DQuat(1, 0, 0, 0)));
  CHECK(optical.write(0, {0, 0, 0}, DQuat(0.5, -0.5, 0.5, -0.5)));
  const RosPublisher<RosPointCloud2> points(participant, "rt/moved/points", RosDelivery::bestEffort),
      still(participant, "rt/moved/still", RosDelivery::latched);
  std::atomic<bool> armMoves = true;
  const SendingCamera sender(ownNetwork(), "moved/depth", infoOf(kCamera),
                             [](int) { return pictureOf(kCamera, flat); });
  const Sending moving([&](int frame, std::int64_t stamp_ns) {
    if (armMoves) arm.write(stamp_ns, {0, 0, 0.001 * frame}, DQuat(half, 0, 0, half));
    SentPoints sent = pointsOf(kCamera, flat);
    sent.stamp_ns = stamp_ns;
    sent.write(points);
    sent.write(still);
  });
  RosWatching inMap = watching();
  inMap.listening.frame = "/map";
  for (const char* topic : {"moved/depth/image_raw", "moved/points"}) {
    CAPTURE(topic);
    const auto stream = watchRosFrames(topic, inMap);
    const Read read = readUntil(*stream, [](const Read& r) { return r.frames.size() == 8; });
    REQUIRE(read.frames.size() == 8);
    CHECK(read.losses.empty());
    for (const DepthFrame& frame : read.frames) {
      REQUIRE(frame.pose.has_value());
      // The image centre, 2 m ahead: the arm is rotated by a quarter, so that it is along y.
      const DVec3 seen = frame.pose->toWorld(DVec3(0, 0, 2));
      CHECK(std::abs(seen.x - 10) < 1e-9);
      CHECK(std::abs(seen.y - 2) < 1e-9);
    }
    const double rise = read.frames[7].pose->centre.z - read.frames[0].pose->centre.z;
    CHECK(rise == near(0.007, 0.4));
  }
  const PointCloud cloud = hearRosCloud("moved/still", inMap.listening);
  REQUIRE(cloud.size() == 32 * 24);
  CHECK(cloud.fileCoordinates(0).y == near(2, 1e-6));
  CHECK(std::abs(cloud.fileCoordinates(0).x - 10) < 2);
  // Without new transforms the arm's position becomes unknown.
  const auto stream = watchRosFrames("moved/points", inMap);
  armMoves = false;
  const Read read = readUntil(*stream, [](const Read& r) { return r.losses.size() == 2; });
  REQUIRE(read.losses.size() == 2);
  CHECK(says(read.losses[0], "the pose of the frame 'arm' in 'mast' was received"));
  CHECK(says(read.losses[0], "too old"));
}

TEST_CASE("a frame without a path to the requested one is reported, and used once the transform arrives") {
  const Participant participant = rosParticipant(ownNetwork());
  const RosPublisher<RosPointCloud2> points(participant, "rt/unjoined", RosDelivery::reliable),
      still(participant, "rt/unjoined_still", RosDelivery::latched);
  const Sending sender([&](int, std::int64_t stamp_ns) {
    SentPoints sent = pointsOf(kCamera, flat);
    sent.frame = "lonely";
    sent.stamp_ns = stamp_ns;
    sent.write(points);
    sent.write(still);
  });
  RosWatching inMap = watching(0.6);
  inMap.listening.frame = "map";
  const std::string words = "is in the frame 'lonely', from which no transform on /tf_static and /tf leads to 'map'";
  CHECK(says(errorOf([&] { watchRosFrames("unjoined", inMap); }), words));
  CHECK(says(errorOf([&] { hearRosCloud("unjoined_still", inMap.listening); }), words));
  std::jthread late([&](const std::stop_token& stops) {
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    RosTransformPublisher stands(participant, "map", "lonely", true);
    stands.write(0, {0, 0, 7}, DQuat(1, 0, 0, 0));
    while (!stops.stop_requested()) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  });
  inMap.listening.timeout_s = 10;
  DepthFrame frame;
  REQUIRE(watchRosFrames("unjoined", inMap)->next(frame));
  CHECK(frame.pose->centre == DVec3(0, 0, 7));
}

TEST_CASE("overlong and empty transform messages move nothing and cause no failure") {
  const Participant participant = rosParticipant(ownNetwork());
  const RosPublisher<RosTFMessage> tf(participant, "rt/tf", RosDelivery::reliable);
  RosTransformIntake intake(participant, "map");
  RosTransformPublisher good(participant, "map", "good", true);
  char parent[] = "map", child[] = "many";
  std::vector<geometry_msgs_msg_dds__TransformStamped_> many(20'000);
  for (auto& one : many) {
    one.header.frame_id = parent;
    one.child_frame_id = child;
    one.transform.rotation.w = std::nan("");
  }
  RosTFMessage hostile{};
  give(hostile.transforms, many);
  const RosTFMessage empty{};
  for (int i = 0; i < 20; ++i) {
    CHECK(tf.write(hostile));
    CHECK(tf.write(empty));
  }
  CHECK(good.write(0, {1, 0, 0}, DQuat(1, 0, 0, 0)));
  RosHeader header{};
  header.frame_id = child;
  CHECK(says(errorOf([&] { intake.poseOf(header); }), "no transform on"));
  char name[] = "good";
  header.frame_id = name;
  double x = 0;
  CHECK(
      within(5, [&] { return errorOf<NetworkError>([&] { x = intake.poseOf(header).centre.x; }).empty() && x == 1; }));
}

TEST_CASE("a topic of another type or without a sender is reported before a message arrives") {
  const Participant participant = rosParticipant(ownNetwork());
  const RosPublisher<RosPoseStamped> pose(participant, "rt/pose", RosDelivery::reliable);
  const std::string words = "the topic has type geometry_msgs/msg/PoseStamped, not ";
  CHECK(says(errorOf([&] { whatRosSends("pose", watching().listening); }),
             words + "sensor_msgs/msg/PointCloud2 or sensor_msgs/msg/Image"));
  CHECK(says(errorOf([&] { hearRosCloud("/pose", watching().listening); }), words + "sensor_msgs/msg/PointCloud2"));
  CHECK(says(errorOf([&] { watchRosFrames("nobody", watching(0.3)); }), "no sender was found in 0.3 s"));
  CHECK(says(errorOf([&] { watchRosFrames("a//b", watching()); }), "is not a valid name"));
  const std::atomic<bool> stop = true;
  RosWatching stopped = watching();
  stopped.listening.stop = &stop;
  CHECK(says(errorOf([&] { watchRosFrames("nobody", stopped); }), "interrupted"));
}

}  // namespace palpate::ros_frames_test
