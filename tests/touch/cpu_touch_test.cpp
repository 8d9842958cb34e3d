// The CPU back end compared with a double-precision reference that searches the whole cloud. Needs no GPU.
#include "engine/touch/cpu_touch.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "engine/contact/contact_reference.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/held_contact.hpp"
#include "engine/core/statistics.hpp"
#include "shaders/shared/edit.h"
#include "tests/near.hpp"
#include "tests/scenes.hpp"

namespace palpate::cpu_touch_test {

namespace {

BrushOptions softPush() { return {.yieldDepth = 0.3, .pushRate = 0.2, .radius = 8}; }

void checkEqualsReference(const Scene& scene, const std::vector<DVec3>& path, const CpuTouchOptions& options) {
  CpuTouch touch(scene.cloud, options);
  ContactReference reference(scene.cloud, options.radius);
  std::size_t touched = 0, wrong = 0;
  for (const DVec3& hip : path) {
    const Contact answer = touch.query({.hip = hip}, 0), expected = reference.query({.hip = hip}, 0);
    touched += expected.touching;
    wrong += !answer.valid || !answer.fresh || answer.touching != expected.touching ||
             answer.neighbours != expected.neighbours ||
             glm::distance(answer.proxy, expected.proxy) > 1e-9 * options.radius ||
             glm::distance(answer.normal, expected.normal) > 1e-9;
  }
  CHECK(wrong == 0);
  CHECK(touched > path.size() / 10);
  CHECK(touched < path.size());
}

}  // namespace

TEST_CASE("the CPU back end equals the reference over random paths on every shape") {
  for (const std::string_view name : shapeNames()) {
    CAPTURE(name);
    const Scene scene = makeScene(name, 20'000);
    std::vector<DVec3> path;
    for (const std::uint32_t seed : {1u, 2u, 3u}) {
      std::ranges::copy(wanderingPath(scene, 150, 0.5 * scene.radius, seed), std::back_inserter(path));
      path.push_back(1000.0 * path.back());  // lets go before the next start
    }
    checkEqualsReference(scene, path, {.radius = scene.radius});
  }
}

TEST_CASE("the CPU back end equals the reference far from the origin, for both bucket keys and every cell size") {
  const Scene far = makeScene("torus", 10'000, DVec3(1e6, -2e6, 3e6));
  checkEqualsReference(far, wanderingPath(far, 150, 0.5 * far.radius, 5), {.radius = far.radius});
  const Scene scene = makeScene("bumpy-sphere", 10'000);
  for (const double cell : {0.01 * scene.radius, 0.3 * scene.radius, 3 * scene.radius, 1000.0})
    checkEqualsReference(scene, wanderingPath(scene, 100, 0.5 * scene.radius, 4),
                         {.radius = scene.radius, .cell = cell, .bucketKey = BucketKey::morton});
}

TEST_CASE("on the CPU clouds of at most two points are never touched; many coincident points are") {
  for (const std::size_t count : {0, 1, 2, 100'000}) {
    PointCloud cloud;
    cloud.positions.assign(count, Vec3(1, 2, 3));
    cloud.normals.assign(count, Vec3(0, 0, 1));
    CpuTouch touch(cloud, {.radius = 1});
    bool touched = false;
    for (const double z : {5.0, 3.5, 3.1, 2.9, 2.6}) {
      const Contact contact = touch.query({.hip = {1, 2, z}}, 0);
      CHECK(contact.valid);
      touched = touched || contact.touching;
    }
    touch.finish();
    CHECK(touched == (count > 2));
  }
}

TEST_CASE("on the CPU a HIP that is not a number gives an invalid contact, and the next one is valid") {
  const Scene scene = makeScene("sphere", 5'000);
  CpuTouch touch(scene.cloud, {.radius = scene.radius, .brush = softPush()});
  CHECK_FALSE(touch.query({.hip = {0, std::nan(""), 0}}, 0).valid);
  CHECK_FALSE(touch.query({.hip = {0, 1e300, 0}}, 0).valid);
  CHECK(touch.query({.hip = {0, 0, 60}}, 0).valid);
  CHECK(touch.query({.hip = {0, 0, 49}}, 0).touching);
  touch.finish();
}

TEST_CASE("a stroke's first edit moves each point as the brush specifies, by a first step at most") {
  const Scene scene = makeScene("sphere", 20'000);
  const BrushOptions options{.yieldDepth = 0.2, .pushRate = 1, .radius = 9, .resample = false};
  CpuTouch touch(scene.cloud, {.radius = scene.radius, .brush = options});
  touch.query({.hip = {0, 0, 51}}, 0);
  const DVec3 hip(0.3, -0.2, 47);
  const Contact contact = touch.query({.hip = hip}, 0);
  touch.finish();
  PointCloud after = scene.cloud;
  CHECK(touch.readBack(after) > 30);
  const double room = static_cast<double>(shared::kFirstStep) * scene.radius;
  BrushStroke stroke(scene.radius);
  stroke.setBrush(options);
  stroke.feel(contact, hip, contact.proxy - hip, Press::contact, 0);
  const PlacedBrush brush(options, scene.radius, stroke.next(0));
  std::size_t wrong = 0;
  double furthest = 0;
  for (std::size_t i = 0; i < after.size(); ++i) {
    const DVec3 before(scene.cloud.positions[i]), normal(scene.cloud.normals[i]);
    wrong += after.positions[i] != Vec3(brush.brushed(before, normal, {before, normal, room}).position);
    furthest = std::max(furthest, glm::distance(DVec3(after.positions[i]), before));
  }
  CHECK(wrong == 0);
  CHECK(furthest == near(room, 1e-4));
}

TEST_CASE("in real time an edit beyond the budget is bridged by the last answer, and edits that are too slow pause") {
  const Scene scene = makeScene("sphere", 100'000);
  // A brush as wide as the model: an edit moves half of the points.
  const BrushOptions wide{.yieldDepth = 0.1, .pushRate = 1e-6, .radius = 60};
  CpuTouch touch(scene.cloud, {.radius = scene.radius, .brush = wide, .threads = 1});
  constexpr double kNoTime_us = 1;
  touch.query({.time_s = 0, .hip = {0, 0, 51}}, kNoTime_us);
  const Contact fresh = touch.query({.time_s = 0.001, .hip = {0, 0, 49}}, kNoTime_us);
  REQUIRE(fresh.touching);
  CHECK(fresh.fresh);
  const Contact held = touch.query({.time_s = 0.002, .hip = {0, 0, 48.5}}, kNoTime_us);
  CHECK(held.valid);
  CHECK(held.touching);
  if (held.fresh)
    MESSAGE("nothing was late: the edit was over before the next query");
  else
    CHECK(held.proxy.z == near(fresh.proxy.z, 1e-3));
  touch.finish();
  REQUIRE(!touch.report().editTimes_us.empty());
  const bool slow = touch.report().editTimes_us.back() > 1e6 * kStalest_s;
  const std::size_t edits = touch.report().editTimes_us.size(), leftOut = touch.report().shortfalls.editsTooSlow;
  CHECK(touch.query({.time_s = 0.003, .hip = {0, 0, 48.5}}, kNoTime_us).fresh);
  touch.finish();
  // Includes an edit of the wide brush's points that were still pending.
  CHECK(touch.report().editTimes_us.size() >= edits + (slow ? 0 : 1));
  CHECK(touch.report().shortfalls.editsTooSlow == leftOut + (slow ? 1 : 0));
}

TEST_CASE("a tick on the CPU that cannot end within its budget is bridged from a share of the points around the hand") {
  const Scene scene = makeScene("sphere", 300'000);
  const CpuTouchOptions options{.radius = 30, .threads = 1};
  constexpr double kBudget_us = 50;
  CpuTouch touch(scene.cloud, options), whole(scene.cloud, options);
  std::vector<double> bridged_us, whole_us;
  std::size_t fresh = 0, wrong = 0, touched = 0;
  double apart = 0;
  for (int k = 0; k < 150; ++k) {
    const double angle = 0.004 * k, r = std::max(51.0 - 0.1 * k, 46.0);
    const Pose pose{.time_s = 1e-3 * k, .hip = {r * std::sin(angle), 0, r * std::cos(angle)}};
    const Stopwatch first;
    const Contact contact = touch.query(pose, kBudget_us);
    bridged_us.push_back(first.elapsed_us());
    const Stopwatch second;
    const Contact expected = whole.query(pose, 0);
    whole_us.push_back(second.elapsed_us());
    fresh += contact.fresh;
    wrong += !contact.valid || contact.touching != expected.touching;
    if (!contact.touching || !expected.touching) continue;
    ++touched;
    apart = std::max(apart, glm::distance(contact.proxy, expected.proxy));
  }
  MESSAGE("a tick takes " << summarize(bridged_us).p50 << " us in place of " << summarize(whole_us).p50
                          << " us; surfaces are " << apart << " mm apart at most");
  CHECK(summarize(bridged_us).p50 < 0.2 * summarize(whole_us).p50);
  CHECK(fresh == 0);
  CHECK(wrong <= 3);    // where contact begins
  CHECK(apart < 0.45);  // a share of the points is not as even as all are
  CHECK(touched > 90);
  const BridgedTicks bridged = touch.bridged();
  CHECK(bridged.ticks == bridged_us.size());
  CHECK(bridged.thinned == bridged.ticks);
  CHECK(touch.report().shortfalls.thinnedPatches > 1);
  CHECK(touch.report().bridgeTimes_us.size() == bridged.ticks);
  CHECK(whole.bridged().ticks == 0);
  const Pose last{.time_s = 0.15, .hip = {25.7, 0, 37.5}};
  CHECK(touch.query(last, 0).fresh);
  CHECK(glm::distance(touch.query(last, 0).proxy, whole.query(last, 0).proxy) < 0.05);
}

TEST_CASE("while an edit is in progress the hand feels the points as they were before it") {
  const Scene scene = makeScene("sphere", 100'000);
  // As wide as the model, so that an edit takes many ticks, and hardly moves a point.
  const BrushOptions wide{.yieldDepth = 0.1, .pushRate = 1e-6, .radius = 60};
  CpuTouch touch(scene.cloud, {.radius = scene.radius, .brush = wide, .editSize = EditSize::whole, .threads = 1});
  constexpr double kNoTime_us = 1;
  touch.query({.time_s = 0, .hip = {0, 0, 51}}, 0);
  const Contact before = touch.query({.time_s = 0.001, .hip = {0, 0, 49}}, kNoTime_us);
  REQUIRE(before.touching);
  // Three millimetres aside the sphere is 0.1 mm below its tangent plane.
  const Contact aside = touch.query({.time_s = 0.002, .hip = {3, 0, 48.9}}, kNoTime_us);
  CHECK(aside.touching);
  CHECK(glm::length(aside.proxy) == within(glm::length(before.proxy), 0.02));
  if (aside.fresh)
    MESSAGE("nothing was late: the edit was over before the next query");
  else
    CHECK(touch.bridged().ticks == 1);
  CHECK(touch.bridged().thinned == 0);
  touch.finish();
}

TEST_CASE("points that wait for their turn to look ahead are not blocked") {
  const Scene scene = makeScene("sphere", 80'000);
  CpuTouch touch(scene.cloud, {.radius = scene.radius,
                               .brush = BrushOptions{.yieldDepth = 0.3, .pushRate = 1, .radius = 25},
                               .editSize = EditSize::tick,
                               .threads = 1});
  for (int k = 0; k < 100; ++k) touch.query({.time_s = 1e-3 * k, .hip = DVec3(0, 0, 51 - std::min(0.5 * k, 12.0))}, 0);
  touch.finish();
  PointCloud after = scene.cloud;
  CHECK(touch.readBack(after) > 500);
  // A few see others that lag behind, stop before them, and hold up those beside them.
  CHECK(touch.edits()->blocked().moves < 5000);
  CHECK(touch.edits()->blocked().edits == 0);
}

}  // namespace palpate::cpu_touch_test
