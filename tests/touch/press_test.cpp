// Presses that sculpt, and a hand that slides off the open rim of a sheet under load and returns, on each back end.
#include <algorithm>

#include "engine/contact/contact_reference.hpp"
#include "tests/near.hpp"
#include "tests/scenes.hpp"
#include "tests/touch/back_end.hpp"
#include "tests/touch/rim_scene.hpp"

namespace palpate::press_test {

namespace {

BrushOptions softPush() { return {.yieldDepth = 0.3, .pushRate = 0.2, .radius = 8}; }

// The HIP moves straight down onto the top of a sphere of radius 50, to `depth` below it, and stays.
std::vector<Pose> pressPath(double depth, int ticks) {
  std::vector<Pose> poses;
  for (int i = 0; i <= ticks; ++i)
    poses.push_back({.time_s = 1e-3 * i, .hip = {0, 0, 51 - (1 + depth) * std::min(1.0, i / (0.5 * ticks))}});
  return poses;
}

std::vector<Contact> play(TouchBackend& touch, std::span<const Pose> poses) {
  std::vector<Contact> contacts;
  for (const Pose& pose : poses) contacts.push_back(touch.query(pose, 0));
  touch.finish();
  return contacts;
}

}  // namespace

TEST_CASE_FIXTURE(OnBackEnd, "a yielding surface follows the HIP until it is the yield depth away") {
  const Scene scene = makeScene("sphere", 20'000);
  const auto touch = make(scene.cloud, {.radius = scene.radius, .brush = softPush()});
  const auto poses = pressPath(4, onCpuOrGpu(200, 120));
  const auto contacts = play(*touch, poses);
  for (const Contact& contact : contacts) CHECK(contact.valid);
  CHECK(contacts.back().touching);
  CHECK(contacts.back().proxy.z < 46.8);  // from 50 down to 46 + the yield depth, minus the rounding by the average
  CHECK(contacts.back().proxy.z > 46.1);
  REQUIRE(touch->report().firstEdit_s);
  CHECK(*touch->report().firstEdit_s > onCpuOrGpu(0.02, 0.012));
  CHECK(touch->report().editTimes_us.size() > onCpuOrGpu(100u, 50u));

  PointCloud sculpted = scene.cloud;
  const std::size_t moved = touch->readBack(sculpted);
  CHECK(moved > 60);
  CHECK(moved < sculpted.size() / 4);
  double deepest = 50;
  for (const Vec3& position : sculpted.positions) deepest = std::min(deepest, double{glm::length(position)});
  CHECK(deepest == within(46.32, 0.03));  // 46 + the yield depth, plus the offset of the point nearest to the tip
  for (const Vec3& normal : sculpted.normals) CHECK(glm::length(normal) == near(1, 1e-4));

  if (kOnGpu) return;  // the index is compared with a newly loaded cloud in touch_side_test.cpp
  // The index followed: its answer equals the reference on the sculpted cloud.
  const ContactReference reference(sculpted, scene.radius);
  const Contact last = touch->query({.time_s = 1, .hip = poses.back().hip}, 0);
  const SurfaceSample surface = reference.surface(last.proxy, DVec3(0));
  CHECK(std::abs(surface.distance) < 1e-4 * scene.radius);
  CHECK(glm::distance(surface.normal, last.normal) < 1e-9);
  CHECK(surface.neighbours == last.neighbours);
}

TEST_CASE_FIXTURE(
    OnBackEnd, "the same presses give the same contacts and the same cloud, bit by bit, with any number of threads") {
  const Scene scene = makeScene("sphere", onCpuOrGpu(20'000, 10'007));
  std::vector<Contact> first;
  PointCloud firstCloud;
  for (const unsigned threads : {1u, 2u, 3u}) {
    const auto touch = make(scene.cloud, {.radius = scene.radius, .brush = softPush(), .threads = threads});
    const auto contacts = play(*touch, pressPath(3, 60));
    PointCloud cloud = scene.cloud;
    touch->readBack(cloud);
    if (threads == 1) {
      first = contacts;
      firstCloud = cloud;
    }
    for (std::size_t i = 0; i < contacts.size(); ++i) CHECK(contacts[i].proxy == first[i].proxy);
    CHECK(cloud.positions == firstCloud.positions);
    CHECK(cloud.normals == firstCloud.normals);
  }
}

// Pressed 3 mm deep and moved off at 0.1 m/s it loses the surface while it is behind it; then it is caught on the side
// from which it returns.
TEST_CASE_FIXTURE(OnBackEnd,
                  "a hand that loses contact beyond an open rim reports it, and finds contact again from either side") {
  constexpr double kStep_mm = 0.1;
  for (const double side : {-1.0, 1.0}) {
    CAPTURE(side);
    const auto touch = make(openSheet(), {.radius = 4});
    Contact contact;
    DVec3 hip(0.3, 0.2, 4);
    int ticks = 0, lost = 0;
    const auto goTo = [&](const DVec3& to) {
      while (glm::distance(hip, to) > 1e-9) {
        const DVec3 way = to - hip;
        hip = glm::length(way) > kStep_mm ? hip + kStep_mm * glm::normalize(way) : to;
        const bool touched = contact.touching;
        contact = touch->query({.time_s = 1e-3 * ticks++, .hip = hip}, 0);
        CHECK(contact.valid);
        if (!touched || contact.touching) continue;
        ++lost;
        CHECK(contact.isWithin);
      }
    };
    goTo({0.3, 0.2, -3});
    CHECK(contact.touching);
    CHECK_FALSE(contact.isWithin);
    goTo({30, 0.2, -3});
    CHECK_FALSE(contact.touching);
    CHECK(lost == 1);
    goTo({30, 0.2, 3 * side});
    goTo({5, 0.2, 3 * side});
    CHECK_FALSE(contact.touching);
    CHECK_FALSE(contact.isWithin);
    goTo({5, 0.2, -1 * side});
    CHECK(contact.touching);
    CHECK(contact.normal.z * side > 0.99);
    CHECK(lost == 1);
  }
}

}  // namespace palpate::press_test
