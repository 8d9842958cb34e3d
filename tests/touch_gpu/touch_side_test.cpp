#include "engine/touch/touch_side.hpp"

#include <algorithm>

#include "engine/contact/contact_reference.hpp"
#include "engine/render/drawn_cloud.hpp"
#include "engine/touch/memory.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/labels.hpp"
#include "tests/near.hpp"
#include "tests/scenes.hpp"
#include "tests/touch/busy.hpp"

namespace palpate::touch_side_test {

namespace {

BrushOptions softPush() { return {.yieldDepth = 0.3, .pushRate = 0.2, .radius = 8}; }

// Presses straight down on the sphere's top, to `depth` below it.
std::vector<Contact> press(TouchSide& touch, double depth, int ticks, EditLog::Reader* drained = nullptr) {
  std::vector<Contact> contacts;
  for (int i = 0; i <= ticks; ++i) {
    const double z = 51 - (1 + depth) * std::min(1.0, i / (0.5 * ticks));
    contacts.push_back(touch.query({.hip = {0, 0, z}}, 0));
    if (drained) drained->consume(drained->unread().end);
  }
  return contacts;
}

}  // namespace

TEST_CASE_FIXTURE(GpuFixture, "the index follows every edit: later contacts equal those on a newly loaded cloud") {
  const Scene scene = makeScene("torus", 20'000);
  TouchSide touch(device, scene.cloud, {.radius = scene.radius, .brush = softPush()});
  for (int i = 0; i < 40; ++i) touch.query({.hip = {35.0 + 0.1 * i, 0, 15.5 - 0.06 * i}}, 0);
  for (int i = 0; i < 3; ++i) touch.query({.hip = {35, 0, 17.0 + 10 * i}}, 0);
  touch.finish();
  PointCloud sculpted = scene.cloud;
  CHECK(touch.readBack(sculpted) > 30);

  TouchSide fresh(device, sculpted, {.radius = scene.radius});
  for (int i = 0; i < 40; ++i) {
    const Pose pose{.hip = {35.0 + 0.1 * i, 0.3, 16.5 - 0.045 * i}};
    const Contact after = touch.query(pose, 0), loaded = fresh.query(pose, 0);
    CHECK(after.touching == loaded.touching);
    CHECK(glm::distance(after.proxy, loaded.proxy) < 1e-4 * scene.radius);
    if (glm::length(touch.query(pose, 0).proxy - pose.hip) > softPush().yieldDepth) break;  // it yields again
  }
}

TEST_CASE_FIXTURE(CoreGpuFixture, "a reader that falls behind costs edits, never its unread entries" * kFull) {
  // A wide brush, deep inside: every tick moves a fifth of the points slightly.
  const Scene scene = makeScene("sphere", 60'000);
  TouchSide touch(device, scene.cloud,
                  {.radius = scene.radius,
                   .brush = BrushOptions{.yieldDepth = 0.01, .pushRate = 1e-5, .radius = 200, .resample = false}});
  const EditLog::Reader reader(touch.editLog());
  press(touch, 20, 80);
  touch.finish();
  CHECK(touch.report().shortfalls.editsLogFull > 0);
  CHECK(reader.unread().size() > scene.cloud.size());
  CHECK(reader.unread().size() <= touch.editLog().capacity());
}

TEST_CASE_FIXTURE(GpuFixture, "no edit is made while a reader has fallen behind, and edits continue afterwards") {
  const Scene scene = makeScene("sphere", 3'000);
  TouchSide touch(device, scene.cloud, {.radius = scene.radius, .brush = softPush()});
  EditLog& log = touch.editLog();
  EditLog::Reader reader(log);
  for (int strokes = 0; log.room() > 0; ++strokes) {
    REQUIRE(strokes < 10'000);
    log.endStroke();
  }
  press(touch, 3, 20);
  touch.finish();
  const auto leftOut = touch.report().shortfalls.editsLogFull;
  CHECK(leftOut > 5);
  PointCloud cloud = scene.cloud;
  CHECK(touch.readBack(cloud) == 0);
  const auto unread = reader.unread();
  CHECK(unread.size() == 0);
  std::vector<EditMark> marks;
  reader.takeMarks(unread.begin, unread.end, marks);
  press(touch, 3, 20, &reader);
  touch.finish();
  CHECK(touch.report().shortfalls.editsLogFull == leftOut);
  CHECK(touch.readBack(cloud) > 5);
}

TEST_CASE_FIXTURE(GpuFixture, "with a reader that keeps up no edit is dropped") {
  const Scene scene = makeScene("sphere", 5'000);
  TouchSide touch(device, scene.cloud, {.radius = scene.radius, .brush = softPush()});
  EditLog::Reader reader(touch.editLog());
  press(touch, 3, 60, &reader);
  touch.finish();
  CHECK(touch.report().shortfalls.editsLogFull == 0);
}

TEST_CASE_FIXTURE(GpuFixture, "a static cloud never moves, and its tick is one pass") {
  const Scene scene = makeScene("sphere", 5'000);
  TouchSide touch(device, scene.cloud, {.radius = scene.radius});
  press(touch, 3, 20);
  touch.finish();
  PointCloud after = scene.cloud;
  CHECK(touch.readBack(after) == 0);
  CHECK(touch.passes().size() == 1);
}

TEST_CASE("late answers are bridged by the patch, which follows the hand over the surface as the GPU would") {
  const Scene scene = makeScene("sphere", 20'000);
  Device device(
      {.gpu = "",
       .validation = Validation::off});  // GPU-assisted validation waits at every submission: no answer is ever late
  TouchSide touch(device, scene.cloud, {.radius = scene.radius, .wait = Wait::block});
  ContactReference reference(scene.cloud, scene.radius);
  constexpr double kTime_us = 1e7, kNoTime_us = 1;
  double time_s = 0;
  const auto pose = [&](double along, double r) {
    const double angle = along * scene.radius / 50;
    return Pose{.time_s = time_s += 1e-3, .hip = {r * std::sin(angle), 0, r * std::cos(angle)}};
  };
  for (const double r : {50.9, 50.6, 50.3, 50.0, 49.6, 49.5, 49.5}) {  // receives a patch
    const Pose now = pose(0, r);
    CHECK(touch.query(now, kTime_us).fresh);
    reference.query(now, 0);
  }

  const Busy busy(device, 400);

  // Slides one support radius, lets go, and touches again on the way back.
  std::size_t touched = 0, bridged = 0;
  double worst = 0;
  Contact late;
  Pose now;
  for (int i = 0; i <= 80; ++i) {
    now = pose(std::sin(0.02 * i), 49.7 + 0.6 * std::sin(0.1 * i));
    late = touch.query(now, kNoTime_us);
    const Contact truth = reference.query(now, 0);
    CHECK(late.valid);
    CHECK(late.touching == truth.touching);
    touched += truth.touching;
    bridged += !late.fresh;
    worst = std::max(worst, glm::distance(late.proxy, truth.proxy) / scene.radius);
  }
  CHECK(bridged == 81);
  CHECK(touched > 20);
  CHECK(touched < 70);
  CHECK(worst < 1e-3);
  CHECK(touch.report().bridgeTimes_us.size() == bridged);

  // The GPU continues from the CPU's proxy.
  now.time_s += 1e-3;
  const Contact after = touch.query(now, 0);
  CHECK(after.fresh);
  CHECK(after.touching == late.touching);
  CHECK(glm::distance(after.proxy, late.proxy) < 1e-4 * scene.radius);
  touch.finish();
}

TEST_CASE("the GPU continues from the contact state of the CPU after late answers") {
  const Scene scene = makeScene("sphere", 20'000);
  Device device({.gpu = "", .validation = Validation::off});
  TouchSide touch(device, scene.cloud, {.radius = scene.radius, .friction = 1, .wait = Wait::block});
  double time_s = 0;
  for (const double r : {50.9, 50.8, 50.7, 50.6}) touch.query({.time_s = time_s += 1e-3, .hip = {1, 0, r}}, 1e7);
  const Busy busy(device, 100);
  // The pending question is about a HIP outside; then the CPU sees it enter elsewhere and go down.
  bool touching = false;
  for (const DVec3 hip : {DVec3(1, 0, 50.5), DVec3(0.5, 0, 50.3), DVec3(0, 0, 50.2), DVec3(0, 0, 49.8),
                          DVec3(0, 0, 49.4), DVec3(0, 0, 49.0)}) {
    const Contact contact = touch.query({.time_s = time_s += 1e-3, .hip = hip}, 1);
    CHECK_FALSE(contact.fresh);
    touching = contact.touching;
  }
  CHECK(touching);
  // Friction holds the proxy at the entry point. Without the CPU's result the GPU would assume a straight entry from
  // the position of its question, a millimetre away.
  const Contact after = touch.query({.time_s = time_s += 1e-3, .hip = {0.3, 0, 48.9}}, 0);
  CHECK(after.fresh);
  CHECK(after.touching);
  CHECK(std::abs(after.proxy.x) < 0.05);
  CHECK(after.proxy.z == within(50, 0.1));
  touch.finish();
}

TEST_CASE("the patch follows edits") {
  const Scene scene = makeScene("sphere", 20'000);
  Device device({.gpu = "", .validation = Validation::off});
  TouchSide touch(device, scene.cloud,
                  {.radius = scene.radius,
                   .brush = BrushOptions{.yieldDepth = 0.3, .pushRate = 1, .radius = 8},
                   .wait = Wait::block});
  Contact felt;
  Pose pose;
  for (int i = 0; i < 80; ++i) {  // slowly, so that no edit is dropped, until the surface yields no more
    pose = {.time_s = pose.time_s + (i < 75 ? 10 : 1e-3), .hip = {0, 0, std::max(49.0, 51 - 0.1 * i)}};
    felt = touch.query(pose, 1e7);
    REQUIRE(felt.fresh);
  }
  REQUIRE(touch.report().editTimes_us.size() > 3);
  REQUIRE(felt.touching);
  CHECK(felt.proxy.z < 49.7);  // dented: it was at 49.96
  const Busy busy(device, 100);
  pose.time_s += 1e-3;
  const Contact late = touch.query(pose, 1);
  CHECK_FALSE(late.fresh);
  CHECK(late.touching);
  CHECK(glm::distance(late.proxy, felt.proxy) < 1e-4 * scene.radius);
  touch.finish();
}

TEST_CASE_FIXTURE(GpuFixture, "a cloud denser than a tick's limit is subsampled, and this is reported") {
  Scene scene = makeScene("sphere", 100'000);
  scene.radius = 30;  // a tenth of the sphere
  TouchSide touch(device, scene.cloud, {.radius = scene.radius});
  for (int i = 0; i < 8; ++i) CHECK(touch.query({.hip = {0, 0, 60.0 - 2 * i}}, 0).valid);
  touch.finish();
  CHECK(touch.report().shortfalls.thinnedTicks > 0);

  const Scene normal = makeScene("sphere", 100'000);
  TouchSide usual(device, normal.cloud, {.radius = normal.radius});
  press(usual, 2, 20);
  CHECK(usual.report().shortfalls.thinnedTicks == 0);
  CHECK(usual.report().shortfalls.truncatedTicks == 0);
}

TEST_CASE_FIXTURE(CoreGpuFixture, "the predicted memory is the allocated memory, within a twentieth" * kMoreInFull) {
  for (const std::size_t points : {std::size_t{20'000}, byTier<std::size_t>(90'001, 500'003)}) {
    CAPTURE(points);
    const Scene scene = makeScene("sphere", points);
    const GpuMemory predicted = predictGpuMemory(points, false);
    const std::uint64_t before = device.allocatedBytes();
    const TouchSide touch(device, scene.cloud, {.radius = scene.radius, .brush = softPush()});
    const std::uint64_t taken = device.allocatedBytes() - before;
    CHECK(static_cast<double>(taken) == near(static_cast<double>(predicted.total() - predicted.drawnCloud), 0.05));
    const DrawnCloud drawn(device, scene.cloud);
    CHECK(static_cast<double>(device.allocatedBytes() - before) == near(static_cast<double>(predicted.total()), 0.05));
  }
}

TEST_CASE_FIXTURE(GpuFixture, "a cloud that cannot fit is refused with both sizes") {
  const std::uint64_t tooMany = device.ownMemory() / 64;  // two orders of two vec4 alone exhaust it
  CHECK_NOTHROW(requireGpuMemory(device, tooMany / 2, false));
  CHECK_THROWS_WITH_AS(requireGpuMemory(device, tooMany, false), doctest::Contains("MiB"), OutOfGpuMemory);
}

}  // namespace palpate::touch_side_test
