// From where others look at a session's cloud, over a network of this machine.
#include <doctest/doctest.h>

#include <chrono>
#include <functional>
#include <limits>
#include <optional>
#include <thread>

#include "engine/core/clock.hpp"
#include "haptics/sharing/camera_presence.hpp"
#include "haptics/sharing/joined_session.hpp"
#include "tests/sharing/own_network.hpp"

namespace palpate {

using namespace sharing;

namespace {

bool within(double seconds, const std::function<bool()>& holds) {
  for (const Stopwatch since; since.elapsed_s() < seconds;) {
    if (holds()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return holds();
}

PointCloud threePoints() {
  PointCloud cloud;
  cloud.origin = DVec3(450'000, -300'000, 1000);
  cloud.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  cloud.normals.assign(3, Vec3(0, 0, 1));
  return cloud;
}

CameraPlace cameraAt(double x) {
  return {.position = DVec3(450'000 + x, -300'000.25, 1007),
          .turn = DQuat(0.5, -0.5, 0.5, -0.5),
          .fovY_rad = 0.75,
          .aspect = 1.5};
}

/// One who has joined and looks.
struct Looking {
  Looking(const std::string& session, const std::string& name, bool near = false)
      : joined(joinCloud(session, {.network = ownNetwork(), .near = near})),
        cameras(shareCameras(joined.session, name, joined.cloud)) {}
  bool sees(double x, double seconds = 10) const {
    return within(seconds, [&] {
      for (const SeenCamera& other : cameras->others())
        if (glm::distance(other.place.position, cameraAt(x).position) < 1e-9) return true;
      return false;
    });
  }
  JoinedCloud joined;
  std::shared_ptr<SharedCameras> cameras;
};

}  // namespace

TEST_CASE("cameras are seen where they are, follow, stay seen while they stand, and are gone when they are hidden") {
  const PointCloud cloud = threePoints();
  Served served(cloud, "looked at");
  const Looking ada("looked at", "Ada"), bert("looked at", "Bert", true);
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  CHECK(ada.cameras->others().empty());  // nobody has said anything
  ada.cameras->show(cameraAt(2));
  REQUIRE(bert.sees(2));
  const SeenCamera seen = bert.cameras->others().at(0);
  CHECK(seen.name == "Ada");
  CHECK(seen.place.turn == cameraAt(2).turn);
  CHECK(seen.place.fovY_rad == 0.75);
  CHECK(seen.place.aspect == 1.5);
  CHECK(ada.cameras->others().empty());  // none sees himself
  ada.cameras->show(cameraAt(3));
  CHECK(bert.sees(3));
  bert.cameras->show(cameraAt(-4));
  CHECK(ada.sees(-4));
  CHECK(ada.cameras->others().at(0).number != seen.number);
  // Longer than a silent one is kept.
  std::this_thread::sleep_for(std::chrono::milliseconds(3500));
  REQUIRE(bert.sees(3, 0));
  CHECK(bert.cameras->others().at(0).age_s < 2);
  // Who comes later sees it, too.
  const Looking carla("looked at", "");
  CHECK(carla.sees(3));
  ada.cameras->show(std::nullopt);
  CHECK(within(5, [&] { return bert.cameras->others().empty(); }));
  std::this_thread::sleep_for(std::chrono::milliseconds(700));
  CHECK(bert.cameras->others().empty());
  CHECK_THROWS_AS(ada.cameras->show(CameraPlace{.fovY_rad = 4}), UsageError);
}

TEST_CASE("a camera that moves a thousand times a second is heard thirty times, and one that stands twice") {
  const PointCloud cloud = threePoints();
  Served served(cloud, "shaken");
  const Looking ada("shaken", "Ada");
  const Participant participant(ownNetwork());
  const Topics own(participant);
  const Reader<Camera> heard(participant, own.cameras, keepingLast(bestEffortQos(), 1000));
  ada.cameras->show(cameraAt(0));
  std::size_t samples = 0;
  REQUIRE(within(10, [&] { return (samples += heard.take([](const Camera&) {})) > 0; }));
  const auto heardIn = [&](double seconds, bool moves) {
    std::size_t count = 0;
    double x = 0;
    for (const Stopwatch since; since.elapsed_s() < seconds;) {
      if (moves) ada.cameras->show(cameraAt(x += 0.01));
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      count += heard.take([](const Camera&) {});
    }
    return count;
  };
  const std::size_t moving = heardIn(2, true);
  CHECK(moving <= 61);
  CHECK(moving > 10);
  heardIn(0.2, false);
  const std::size_t standing = heardIn(2.1, false);
  CHECK(standing <= 5);
  CHECK(standing >= 2);
}

TEST_CASE(
    "cameras that are none, of other sessions, or ever new ones, are not seen, or no more of them than there is room "
    "for") {
  const PointCloud cloud = threePoints();
  Served served(cloud, "looked at by strangers");
  const Looking ada("looked at by strangers", "Ada");
  const Participant participant(ownNetwork());
  const Topics topics(participant);
  const Writer<Camera> writer(participant, topics.cameras, bestEffortQos());
  std::uint32_t number = 0;
  const auto good = [&] {
    Camera camera{};
    set(camera.session, ada.joined.session->session);
    camera.client[0] = 1;
    put(camera.name, "a\033[31mb");
    for (int axis = 0; axis < 3; ++axis) camera.position[axis] = cameraAt(1).position[axis];
    camera.orientation[3] = 1;
    camera.fov_y = 1;
    camera.aspect = 1;
    camera.number = ++number;
    return camera;
  };
  const auto isSeen = [&](Camera camera, double seconds) {
    return within(seconds, [&] {
      camera.number = ++number;
      writer.write(camera);
      return !ada.cameras->others().empty();
    });
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kShort_s = 0.3;
  // The first one that is heard may have any number.
  Camera first = good();
  first.number = 0;
  REQUIRE(within(10, [&] {
    writer.write(first);
    return !ada.cameras->others().empty();
  }));
  CHECK(isCamera(ada.cameras->others().at(0).place));
  REQUIRE(isSeen(good(), 10));
  CHECK(ada.cameras->others().at(0).name == "a?[31mb");
  REQUIRE(within(5, [&] { return ada.cameras->others().empty(); }));
  const auto spoilt = [&](const std::function<void(Camera&)>& spoil) {
    Camera camera = good();
    spoil(camera);
    return isSeen(camera, kShort_s);
  };
  CHECK_FALSE(spoilt([&](Camera& camera) { camera.position[1] = kNan; }));
  CHECK_FALSE(spoilt([](Camera& camera) { camera.position[2] = 1e300; }));
  CHECK_FALSE(
      spoilt([](Camera& camera) { camera.position[2] = 1e9; }));  // beyond what a cloud of this size is seen from
  CHECK_FALSE(spoilt([&](Camera& camera) { camera.orientation[0] = static_cast<float>(kNan); }));
  CHECK_FALSE(spoilt([](Camera& camera) { camera.orientation[3] = 0; }));
  CHECK_FALSE(spoilt([](Camera& camera) { camera.fov_y = 0; }));
  CHECK_FALSE(spoilt([](Camera& camera) { camera.fov_y = 3.2F; }));
  CHECK_FALSE(spoilt([](Camera& camera) { camera.aspect = -1; }));
  CHECK_FALSE(spoilt([](Camera& camera) { camera.session[3] ^= 1; }));
  CHECK_FALSE(spoilt([&](Camera& camera) { set(camera.client, ada.joined.session->client); }));
  REQUIRE(isSeen(good(), 5));
  // One after the other, so that none is lost for another one's sake.
  for (std::uint32_t i = 0; i < 600; ++i) {
    Camera camera = good();
    camera.client[1] = static_cast<std::uint8_t>(i);
    camera.client[2] = static_cast<std::uint8_t>(i >> 8);
    writer.write(camera);
    if (i % 50 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  CHECK(within(5, [&] { return ada.cameras->others().size() == 256; }));
  CHECK(ada.cameras->others().size() <= 256);
}

}  // namespace palpate
