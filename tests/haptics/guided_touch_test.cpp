#include "haptics/devices/guided_touch.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <thread>

#include "engine/core/error.hpp"
#include "haptics/devices/replay_device.hpp"
#include "haptics/servo_loop.hpp"
#include "tests/haptics/contact_doubles.hpp"
#include "tests/near.hpp"

namespace palpate::guided_touch_test {
namespace {

const DVec3 kParked(0, 0, 300);

/// Counts restarts of touch.
class CountingContact final : public SphereContact {
 public:
  using SphereContact::SphereContact;
  void resetHand(std::size_t /*hand*/) noexcept override { ++begins; }
  int begins = 0;
};

class Recorder final : public TickRecorder {
 public:
  void ticked(const TraceRow& row, const DeviceState&) noexcept override {
    if (count < rows.size()) rows[count] = row;
    ++count;
  }
  std::vector<TraceRow> rows = std::vector<TraceRow>(10'000);
  std::atomic<std::size_t> count = 0;
};

/// A stroke onto the sphere of radius 50 from above, and along it.
DrawnPose drawnPose(int tick) {
  const DVec3 outward = glm::normalize(DVec3(1e-4 * tick, 0, 1));
  return {.place = 50.0 * outward, .outward = outward, .toEye = {0, 0, 1}, .inward = 2, .putDown = tick == 0};
}

}  // namespace

TEST_CASE("a lifted stylus is parked, and put down at the hand's first aim") {
  GuidedTouch device({}, kParked);
  CHECK(glm::distance(device.read(0).position, kParked) < 0.01);
  CHECK(!device.read(0.001).putDown);
  device.aim({10, 20, 30});
  const DeviceState down = device.read(0.002);
  CHECK(down.putDown);
  CHECK(glm::distance(down.position, DVec3(10, 20, 30)) < 0.01);
  CHECK(!device.read(0.003).putDown);
  device.aim({11, 20, 30});
  CHECK(!device.read(0.004).putDown);  // a motion
  device.lift();
  const DeviceState lifted = device.read(0.005);
  CHECK(lifted.putDown);
  CHECK(glm::distance(lifted.position, kParked) < 0.01);
}

TEST_CASE("a stylus lifted and put down between two reads counts as lifted") {
  GuidedTouch device({}, kParked);
  device.aim({0, 0, 10});
  device.read(0);
  device.lift();
  device.aim({0, 50, 10});
  const DeviceState state = device.read(0.001);
  CHECK(state.putDown);
  CHECK(glm::distance(state.position, DVec3(0, 50, 10)) < 0.01);
}

TEST_CASE("a hand with a far aim glides to it no faster than a hand moves, and arrives") {
  GuidedTouch device({}, kParked);
  device.aim({0, 0, 0});
  DVec3 last = device.read(0).position;
  device.aim({100, 0, 0});
  double fastest = 0;
  for (int tick = 1; tick <= 1000; ++tick) {
    const DVec3 now = device.read(tick * 1e-3).position;
    fastest = std::max(fastest, glm::distance(now, last) * 1000);
    last = now;
  }
  CHECK(fastest > 100);
  CHECK(fastest < 1000);
  CHECK(glm::distance(last, DVec3(100, 0, 0)) < 0.1);
}

TEST_CASE("the surface stops the stylus while the aim is inside it") {
  GuidedTouch device({}, kParked);
  CountingContact sphere(50);
  device.aim({0, 0, 55});
  Recorder recorder;
  std::atomic<bool> stop = false;
  ServoLoop loop(device, sphere, ForceLaw({}, {}), {.duration_s = 2.0, .recorder = &recorder});
  // In virtual time the observer must change the aim, while the loop runs.
  const ServoResult result = loop.run([&](const TraceRow& row) {
    if (row.time_s > 0.5) device.aim({0, 0, 46});
  });
  const TraceRow& last = result.trace().rows.back();
  CHECK(last.contact);
  CHECK(last.hip.z > 47);  // aimed at 46
  CHECK(last.hip.z < 49.5);
  CHECK(last.force_N.z > 0.5);
  CHECK(sphere.begins == 1);
  CHECK(result.trace().rows.front().putDown);
}

TEST_CASE("an endless session runs until it is stopped, keeps no trace, and starts at the given time") {
  GuidedTouch device({}, kParked);
  CountingContact sphere(50);
  Recorder recorder;
  std::atomic<bool> stop = false;
  ServoLoop loop(device, sphere, ForceLaw({}, {}),
                 {.begin_s = 12.5, .endless = true, .realtime = true, .stop = &stop, .recorder = &recorder});
  std::jthread servo([&] {
    const ServoResult result = loop.run();
    CHECK(result.trace().rows.empty());
    CHECK(!result.deviceFailed);
  });
  while (recorder.count < 50) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  stop = true;
  servo.join();
  CHECK(recorder.rows[0].time_s >= 12.5 - 1e-9);  // a machine may miss the first ones
  CHECK(recorder.rows[0].time_s < 12.6);
  CHECK(recorder.rows[40].time_s >= 12.54 - 1e-9);
  CHECK_THROWS_AS(ServoLoop(device, sphere, ForceLaw({}, {}), {.endless = true, .stop = &stop}), UsageError);
  CHECK_THROWS_AS(ServoLoop(device, sphere, ForceLaw({}, {}), {.endless = true, .realtime = true}), UsageError);
}

TEST_CASE("an aim that is not a number is ignored") {
  GuidedTouch device({}, kParked);
  device.aim({1, 2, 3});
  device.read(0);
  device.aim({NAN, 0, 0});
  CHECK(glm::distance(device.read(0.001).position, DVec3(1, 2, 3)) < 0.01);
}

TEST_CASE(
    "a drawn stroke has a pose a tick; until the next one nothing is asked, and there is neither force nor time") {
  GuidedTouch device({}, kParked, {.countsTicks = true});
  for (int tick = 0; tick < 40; ++tick) device.draw(drawnPose(tick));
  CountingContact sphere(50);
  ServoLoop loop(device, sphere, ForceLaw({}, {}), {.duration_s = 0.1});
  const auto rows = loop.run().trace().rows;
  REQUIRE(rows.size() == 40);
  for (std::size_t i = 0; i < rows.size(); ++i) CHECK(rows[i].time_s == within(1e-3 * double(i), 1e-9));
  CHECK(rows.back().contact);
  CHECK(glm::distance(rows.back().hip, rows.back().proxy) == near(2, 1e-3));
  CHECK(device.read(1).waits);
  device.draw({.place = {0, 0, 50}, .outward = {0, 0, 1}, .toEye = {0, 0, 1}, .inward = 2, .ends = true});
  const DeviceState ended = device.read(1);
  CHECK(ended.putDown);
  CHECK(ended.buttons == 0);
  CHECK_FALSE(device.read(1).waits);
}

TEST_CASE("where ticks have the time of the clock, a drawn stylus rests until its next pose") {
  GuidedTouch device({}, kParked);
  for (int tick = 0; tick < 40; ++tick) device.draw(drawnPose(tick));
  DeviceState state;
  for (int tick = 0; tick < 40; ++tick) state = device.read(tick);
  const DeviceState rests = device.read(40);
  CHECK_FALSE(rests.waits);
  CHECK(rests.position == state.position);
  CHECK(rests.buttons == kSculptButton);
}

TEST_CASE("a hand without a device presses as hard as long as it wants: there are no motors that get hot") {
  GuidedTouch device({}, kParked);
  device.aim({0, 0, 52});
  SphereContact sphere(50);
  ServoLoop loop(device, sphere, ForceLaw({}, {}), {.duration_s = 15});
  const ServoResult result = loop.run([&](const TraceRow& row) {
    if (row.time_s > 0.6) device.aim({0, 0, 40});
  });
  const auto& rows = result.trace().rows;
  CHECK(glm::length(rows[2000].force_N) > 2);
  CHECK(glm::length(rows.back().force_N) == near(glm::length(rows[2000].force_N), 1e-3));
}

TEST_CASE("a drawn stroke follows the surface that it raises, and is put down again where it stays behind") {
  const DVec3 up(0, 0, 1);
  double height = 0;  // of the last time that it was put down
  const auto putDowns = [&](const DVec3& way, int felt = 400) {
    GuidedTouch device({}, kParked, {.countsTicks = true});
    int count = 0;
    for (int tick = 0; tick < 400; ++tick) {
      device.draw({.place = {0, 0, 50}, .outward = up, .toEye = up, .inward = 2, .putDown = tick == 0});
      const DeviceState state = device.read(1e-3 * tick);
      count += state.putDown;
      if (state.putDown) height = state.position.z;
      const DVec3 proxy = DVec3(0, 0, 50) + double(std::max(tick - 50, 0)) * way;
      device.feel(tick < felt ? std::optional(proxy - state.position) : std::nullopt);
    }
    return count;
  };
  CHECK(putDowns(0.03 * up) == 1);
  CHECK(putDowns(DVec3(0.03, 0, 0)) > 1);
  CHECK(putDowns(0.03 * up, 300) == 2);  // lost: above what it has raised, not in it
  CHECK(height > 50 + 0.03 * 240);
}

TEST_CASE("a stroke that is far behind its pointer catches up, if it may") {
  for (const bool catchesUp : {false, true}) {
    GuidedTouch device({}, kParked, {.countsTicks = true, .catchesUp = catchesUp});
    for (int tick = 0; tick < 1000; ++tick) device.draw(drawnPose(tick));
    int reads = 0;
    DeviceState state;
    for (; device.isDrawing(); ++reads) state = device.read(reads * 1e-3);
    if (catchesUp)
      CHECK(reads < 400);
    else
      CHECK(reads == 1000);
    CHECK(glm::distance(state.position, 48.0 * drawnPose(999).outward) < 0.2);
  }
}

TEST_CASE("a drawn stylus that has lost contact is put down again, one that holds is not") {
  for (const bool holds : {false, true}) {
    GuidedTouch device({}, kParked);
    int putDowns = 0;
    for (int tick = 0; tick < 400; ++tick) {
      DrawnPose pose = drawnPose(tick);
      if (holds) pose.holdsFrom = 0.5;
      device.draw(pose);
      putDowns += device.read(tick * 1e-3).putDown;
      device.feel({});
    }
    CHECK(putDowns == (holds ? 1 : 2));
  }
}

TEST_CASE("a replay puts the stylus down where the session did, once") {
  ReplayDevice device({{.time_s = 0, .device = {0, 0, 60}},
                       {.time_s = 0.001, .device = {0, 30, 60}, .flags = LoggedTick::kPutDown},
                       {.time_s = 0.002, .device = {0, 31, 60}}},
                      {});
  CHECK(!device.read(0).putDown);
  CHECK(device.read(0.001).putDown);
  CHECK(!device.read(0.0015).putDown);
  CHECK(!device.read(0.002).putDown);
}

}  // namespace palpate::guided_touch_test
