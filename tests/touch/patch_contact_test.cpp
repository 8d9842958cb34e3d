// The CPU's answers from a patch of points while the GPU is late, compared with the double-precision reference over the
// whole cloud.
#include "engine/touch/patch_contact.hpp"

#include <algorithm>
#include <bit>

#include <doctest/doctest.h>
#include "engine/contact/carried_patch.hpp"
#include "engine/contact/contact_reference.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/statistics.hpp"

#include "shaders/shared/contact.h"
#include "tests/near.hpp"
#include "tests/scenes.hpp"

namespace palpate::patch_contact_test {

namespace {

const double kReach = static_cast<double>(shared::kCarriedReach);

// A patch cut from the cloud as on the GPU.
std::vector<Vec4> pointsNear(const PointCloud& cloud, const DVec3& centre, double reach) {
  std::vector<Vec4> points;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (glm::distance(DVec3(cloud.positions[i]), centre) >= reach) continue;
    points.emplace_back(cloud.positions[i], std::bit_cast<float>(static_cast<std::uint32_t>(i)));
    points.emplace_back(cloud.normals[i], 0);
  }
  return points;
}

// The sphere of 50 mm, touched 0.5 mm deep at its top, with the patch around that position.
struct PressedSphere {
  PressedSphere() : reference(scene.cloud, scene.radius), patch({.radius = scene.radius}, 0, DVec3(0)) {
    reference.query({.hip = {0, 0, 51}}, 0);
    const Pose pose{.hip = {0, 0, 49.5}};
    pressed = reference.query(pose, 0);
    patch.take({.centre = Vec3(pressed.proxy), .reach = kReach * scene.radius, .points = points}, {});
    patch.heard(0);
    patch.goOnFrom(pressed, pose,
                   {.started = true,
                    .touching = true,
                    .face = shared::kFaceOutside,
                    .facing = pressed.normal,
                    .lastHip = pose.hip,
                    .proxy = pressed.proxy});
  }

  Scene scene = makeScene("sphere", 50'000);
  ContactReference reference;
  std::vector<Vec4> points = pointsNear(scene.cloud, {0, 0, 50}, kReach* scene.radius + 0.1);
  PatchContact patch;
  Contact pressed;
};

DVec3 at(double angle, double r) { return {r * std::sin(angle), 0, r * std::cos(angle)}; }
double spring(const Contact& contact, const Pose& pose) { return glm::distance(contact.proxy, pose.hip); }

}  // namespace

TEST_CASE_FIXTURE(PressedSphere,
                  "within the border a patch gives the contact of the whole cloud: pressing, sliding and releasing") {
  std::size_t touched = 0;
  std::vector<double> times_us;
  for (int i = 0; i < 200; ++i) {
    const double angle = 0.9 * scene.radius / 50 * std::sin(0.03 * i);
    const Pose pose{.time_s = 1e-4 * i, .hip = at(angle, 49.9 + 0.4 * std::cos(0.1 * i + 2))};
    const Stopwatch watch;
    const Contact bridged = patch.answer(pose);
    times_us.push_back(watch.elapsed_us());
    const Contact truth = reference.query(pose, 0);
    REQUIRE(bridged.valid);
    CHECK_FALSE(bridged.fresh);
    CHECK(bridged.touching == truth.touching);
    CHECK(bridged.neighbours == truth.neighbours);
    CHECK(glm::distance(bridged.proxy, truth.proxy) < 1e-9 * scene.radius);
    CHECK(glm::distance(bridged.normal, truth.normal) < 1e-9);
    touched += truth.touching;
  }
  CHECK(touched > 50);
  CHECK(touched < 180);
  const Summary times = summarize(times_us);
  MESSAGE("a patch of " << points.size() / 2 << " points answers in " << times.p50 << " us (p50), " << times.p999
                        << " us (p99.9)");
}

TEST_CASE_FIXTURE(PressedSphere,
                  "beyond the border of a patch the force fades out without a step, and returns inside") {
  // Slides away at a tenth of a radius a tick, at constant depth.
  double last = spring(pressed, {.hip = {0, 0, 49.5}}), largestStep = 0;
  double time_s = 0, angle = 0;
  int held = 0;
  for (int i = 0; i < 60; ++i) {
    const Pose pose{.time_s = time_s += 1e-3, .hip = at(angle, 49.5)};
    const Contact contact = patch.answer(pose);
    REQUIRE(contact.valid);
    const double now = contact.touching ? spring(contact, pose) : 0;
    largestStep = std::max(largestStep, std::abs(now - last));
    held += contact.touching;
    last = now;
    if (angle * 50 < 1.8 * scene.radius) angle += 0.1 * scene.radius / 50;
  }
  CHECK(held > 15);  // within the border, plus some ticks
  CHECK(last == 0);
  CHECK(largestStep < 0.2 * 0.5);  // of the depth
  const Contact back = patch.answer({.time_s = time_s + 1e-3, .hip = at(0, 49.5)});
  CHECK(back.touching);
  CHECK(back.proxy.z == near(pressed.proxy.z, 1e-5));
}

TEST_CASE_FIXTURE(PressedSphere,
                  "an edit missing from the patch, or the lack of answers, fades the force out in time") {
  double full_s = 0, end_s = 0;
  SUBCASE("an edit missing from the patch") {
    patch.edited(0.5);
    patch.edited(0.51);  // the first edit counts
    full_s = 0.5 + kOutdated_s;
    end_s = 0.5 + kMaxOutdated_s;
  }
  SUBCASE("no further answers") {
    patch.heard(0.5);
    full_s = 0.5 + kSilent_s;
    end_s = 0.5 + kMaxSilent_s;
  }
  patch.heard(end_s > 0.6 ? 0.5 : 0.55);
  const auto shareAt = [&](double time_s) {
    const Pose pose{.time_s = time_s, .hip = {0, 0, 49.5}};
    const Contact contact = patch.answer(pose);
    CHECK(contact.valid);
    return contact.touching ? spring(contact, pose) / spring(pressed, pose) : 0;
  };
  CHECK(shareAt(full_s - 1e-4) == near(1, 1e-4));
  CHECK(shareAt(0.5 * (full_s + end_s)) == near(0.5, 1e-3));
  CHECK(shareAt(end_s - 1e-4) < 0.02);
  CHECK(shareAt(end_s + 1e-4) == 0);
  patch.take({.centre = Vec3(0, 0, 50), .reach = kReach * scene.radius, .points = points}, {});
  patch.heard(end_s);
  CHECK(shareAt(end_s) == near(1, 1e-4));
}

TEST_CASE_FIXTURE(PressedSphere, "a patch with points, or a pose, that are not finite gives only finite answers") {
  std::vector<Vec4> broken = points;
  for (std::size_t i = 0; i < broken.size(); i += 7) broken[i].y = std::nanf("");
  patch.take({.centre = Vec3(0, 0, 50), .reach = kReach * scene.radius, .points = broken}, {});
  const Contact contact = patch.answer({.hip = {0, 0, 49.5}});
  CHECK(contact.valid);
  CHECK(isFinite(contact.proxy));
  CHECK_FALSE(patch.answer({.hip = {0, std::nan(""), 49.5}}).valid);
  patch.take({.centre = Vec3(std::nanf("")), .reach = 1, .points = {}}, {});
  CHECK(patch.needsMore(DVec3(0, 0, 50)));
  CHECK(isFinite(patch.answer({.hip = {0, 0, 49.5}}).proxy));
}

TEST_CASE("without a patch nothing is felt before the first answer") {
  PatchContact patch({.radius = 1}, 0, DVec3(5));
  const Contact contact = patch.answer({.hip = {1, 2, 3}});
  CHECK(contact.valid);
  CHECK_FALSE(contact.touching);
  CHECK(contact.proxy == DVec3(1, 2, 3));
  CHECK_FALSE(patch.isAhead());
}

TEST_CASE_FIXTURE(PressedSphere, "a patch of moving points is extrapolated with the last felt velocity") {
  const double deep = spring(pressed, {.hip = {0, 0, 49.5}});
  const DVec3 velocity(40, 0, 100);
  pressed.velocity = velocity;
  const double asked_s = 0.003, points_s = 0.002;  // the frame was a millisecond old
  patch.take({.centre = Vec3(pressed.proxy), .reach = kReach * scene.radius, .points = points}, {},
             {.true_s = points_s});
  // The surface at that time, the hand 0.5 mm deep.
  const DVec3 moved = (asked_s - points_s) * velocity;
  Contact felt = pressed;
  felt.proxy += moved;
  const Pose asked{.time_s = asked_s, .hip = DVec3(0, 0, 49.5) + moved};
  patch.goOnFrom(felt, asked,
                 {.started = true,
                  .touching = true,
                  .face = shared::kFaceOutside,
                  .facing = pressed.normal,
                  .lastHip = asked.hip,
                  .proxy = felt.proxy,
                  .velocity = velocity,
                  .time_s = asked_s});
  for (int i = 1; i <= 15; ++i) {
    const double time_s = asked_s + 1e-3 * i;
    const Pose pose{.time_s = time_s, .hip = DVec3(0, 0, 49.5) + (time_s - points_s) * velocity};
    const Contact contact = patch.answer(pose);
    CHECK(contact.touching);
    CHECK(contact.velocity == velocity);
    CHECK(spring(contact, pose) == near(deep, 0.002));
    CHECK(std::abs(contact.proxy.x - pose.hip.x) < 0.01);
  }
}

}  // namespace palpate::patch_contact_test
