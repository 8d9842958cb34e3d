#include "haptics/devices/hid_device.hpp"

#include <doctest/doctest.h>

#include "engine/core/error.hpp"
#include "haptics/servo_loop.hpp"
#include "tests/haptics/contact_doubles.hpp"
#include "tests/haptics/fake_hid.hpp"
#include "tests/labels.hpp"
#include "tests/near.hpp"

namespace palpate::hid_device_test {
namespace {

const std::string kPath = "/dev/hidraw3";
constexpr double kTick_s = 1e-3;

/// Report 1 for a push in palpate's axes, -1 to 1.
Report pushed(const DVec3& push) {
  Report report{1};
  for (const double part : {push.x, push.z, -push.y}) {
    const auto number = static_cast<std::int16_t>(std::lround(350 * part));
    report.push_back(static_cast<std::uint8_t>(number & 0xff));
    report.push_back(static_cast<std::uint8_t>((number >> 8) & 0xff));
  }
  return report;
}

/// A 3D mouse, its stylus, and virtual time.
struct Scene {
  std::shared_ptr<FakeHid> hid = std::make_shared<FakeHid>();
  Remarks remarks;
  std::unique_ptr<HidDevice> device;
  int tick = 0;
  std::uint8_t marks = 0;

  explicit Scene(const DVec3& start_mm = DVec3(0), const HidInfo& info = spaceMouse(), bool waitsForForces = true) {
    hid->plug(info);
    device = std::make_unique<HidDevice>(hid, info, start_mm, remarks.sink());
    if (waitsForForces) go(510);
  }
  DeviceState read() { return device->read(tick * kTick_s); }
  /// Sends reports, followed by a button report as a marker, and waits for the marker.
  void send(const std::vector<Report>& reports) {
    for (const Report& report : reports) hid->report(kPath, report);
    hid->report(kPath, {3, ++marks});
    REQUIRE(comesTrue([&] { return read().buttons == marks; }));
  }
  /// Runs ticks over a surface of 1 N/mm below z = `surface_mm`, if that is near. Returns the last state of the stylus.
  DeviceState go(int ticks, double surface_mm = -1000) {
    DeviceState state;
    for (int i = 0; i < ticks; ++i) {
      ++tick;
      state = read();
      force_N = DVec3(0, 0, std::clamp(surface_mm - state.position.z, 0.0, 3.3));
      REQUIRE(device->write(force_N));
      fastest_mm_per_s = std::max(fastest_mm_per_s, glm::distance(state.position, last_mm) / kTick_s);
      last_mm = state.position;
    }
    return state;
  }
  DVec3 force_N{0}, last_mm{0};
  double fastest_mm_per_s = 0;
};

}  // namespace

TEST_CASE("the stylus of a 3D mouse starts at its position and stays there without a push") {
  Scene scene({1, 2, 3});
  CHECK(glm::distance(scene.read().position, {1, 2, 3}) < 0.01);
  CHECK(glm::distance(scene.go(100).position, {1, 2, 3}) < 0.01);
  CHECK(scene.read().ok);
  CHECK(scene.read().rendersForce);
  CHECK(scene.device->name() == "SpaceMouse Compact (256f:c635)");
}

TEST_CASE("the hand waits while forces ramp up") {
  Scene scene(DVec3(0), spaceMouse(), false);
  scene.hid->report(kPath, pushed({1, 0, 0}));
  scene.hid->report(kPath, {3, 1});
  REQUIRE(comesTrue([&] { return scene.device->read(7).buttons == 1; }));
  for (int tick = 1; tick < 500; ++tick) CHECK(glm::length(scene.device->read(7 + tick * kTick_s).position) < 0.01);
  for (int tick = 500; tick < 700; ++tick) scene.device->read(7 + tick * kTick_s);
  CHECK(scene.device->read(7.7).position.x > 10);
}

TEST_CASE("a push is a velocity: the hand moves until the cap is released, without a jerk") {
  Scene scene;
  scene.send({pushed({1, 0, 0})});
  const double half_s = scene.go(500).position.x;
  CHECK(half_s > 45);  // 120 mm/s, after a short acceleration
  CHECK(half_s < 60);
  CHECK(scene.fastest_mm_per_s < 150);
  scene.send({pushed({0, 0, 0})});
  const DVec3 rest = scene.go(300).position;
  CHECK(glm::distance(scene.go(300).position, rest) < 0.01);
  CHECK(rest.x - half_s < 10);
  scene.send({pushed({0, 1, 0})});
  CHECK(scene.go(200).position.y > 10);
  scene.send({pushed({0, 0, -1})});
  CHECK(scene.go(200).position.z < -10);
}

TEST_CASE("the long form of report 1 steers like the short one, and rotation does not steer") {
  Scene scene;
  Report both = pushed({0, 0.8, 0});
  both.resize(13, 0x40);
  scene.send({both});
  const DVec3 up = scene.go(200).position;
  CHECK(up.y > 5);
  CHECK(std::abs(up.x) + std::abs(up.z) < 0.01);
  scene.send({pushed({0, 0, 0}), {2, 0x5e, 1, 0x5e, 1, 0x5e, 1}});
  const DVec3 rest = scene.go(300).position;
  CHECK(glm::distance(scene.go(300).position, rest) < 0.01);
}

TEST_CASE("short and foreign reports between valid ones change nothing") {
  Scene scene;
  scene.send({pushed({0.7, 0, 0}), {}, {1}, {1, 2, 3}, {9, 9, 9, 9, 9, 9, 9}, {2, 1}, Report(100, 0xee)});
  CHECK(scene.go(200).position.x > 5);
  CHECK(scene.remarks.size() == 0);
}

TEST_CASE("the ends of the workspace stop the hand, and it leaves them at once") {
  Scene scene;
  scene.send({pushed({1, 0, 0})});
  CHECK(scene.go(2000).position.x == near(0.5 * kTouchWorkspace_mm.x, 1e-6));
  scene.send({pushed({-1, 0, 0})});
  CHECK(scene.go(150).position.x < 0.5 * kTouchWorkspace_mm.x - 5);
}

TEST_CASE("the surface stops the stylus, and a harder push presses harder") {
  Scene scene({0, 0, 10});
  scene.send({pushed({0, 0, -0.5})});
  const DVec3 soft = scene.go(1500, 0).position;
  const double soft_N = scene.force_N.z;
  CHECK(soft.z < -0.2);
  scene.send({pushed({0, 0, -1})});
  scene.go(1000, 0);
  const double hard_N = scene.force_N.z;
  CHECK(soft_N > 0.3);
  CHECK(hard_N > 1.4 * soft_N);
  CHECK(hard_N < 3.2);
  // A released cap presses only lightly, however long it was pushed before.
  scene.send({pushed({0, 0, 0})});
  scene.go(800, 0);
  CHECK(scene.force_N.z < 0.4);
  CHECK(scene.force_N.z > 0.1);
  // It leaves the surface without delay.
  scene.send({pushed({0, 0, 0.6})});
  CHECK(scene.go(100, 0).position.z > 0);
}

TEST_CASE("unplugged during a touch, the stylus stays without force; plugged in again, it continues from there") {
  Scene scene({0, 0, 10});
  scene.send({pushed({0.2, 0, -1})});
  scene.go(700, 0);
  REQUIRE(scene.force_N.z > 1);
  scene.hid->unplug(kPath);
  REQUIRE(comesTrue([&] { return !scene.read().rendersForce; }));
  const DVec3 left = scene.read().position;
  CHECK(scene.read().ok);
  CHECK(scene.read().buttons == 0);
  scene.go(3000, 0);
  CHECK(scene.read().position == left);
  CHECK(scene.device->faultText().empty());
  REQUIRE(comesTrue([&] { return scene.remarks.size() == 1; }));
  CHECK(scene.remarks.count("SpaceMouse Compact (256f:c635) was unplugged: the stylus stays where it is") == 1);

  scene.hid->plug(spaceMouse("/dev/hidraw6", "B2"));  // another device of the same model
  scene.hid->plug(keyboard());
  std::this_thread::sleep_for(std::chrono::milliseconds(800));
  CHECK(!scene.read().rendersForce);
  scene.hid->plug(spaceMouse("/dev/hidraw8", "A1"));  // the same device under another name
  REQUIRE(comesTrue([&] { return scene.read().rendersForce; }));
  CHECK(scene.read().position == left);
  CHECK(!scene.read().putDown);  // it has not moved
  CHECK(scene.remarks.count("is back, at /dev/hidraw8") == 1);
  CHECK(scene.remarks.size() == 2);
  scene.fastest_mm_per_s = 0;
  scene.go(600, 0);
  CHECK(scene.fastest_mm_per_s < 500);  // the surface pushes it out without a jump
  scene.hid->report("/dev/hidraw8", pushed({1, 0, 0}));
  scene.hid->report("/dev/hidraw8", {3, 0x55});
  REQUIRE(comesTrue([&] { return scene.read().buttons == 0x55; }));
  CHECK(scene.go(200).position.x > left.x + 5);
}

TEST_CASE("a push held at an unplugging has no effect after the reconnection") {
  Scene scene;
  scene.send({pushed({1, 0, 0})});
  scene.go(100);
  scene.hid->unplug(kPath);
  REQUIRE(comesTrue([&] { return !scene.read().rendersForce; }));
  scene.hid->plug(spaceMouse());
  REQUIRE(comesTrue([&] { return scene.read().rendersForce; }));
  const DVec3 before = scene.read().position;
  CHECK(glm::distance(scene.go(1000).position, before) < 0.6);
}

TEST_CASE("a reconnected device without permission is reported once, and used once permitted") {
  Scene scene;
  scene.hid->deny(kPath);
  const Stopwatch watch;
  scene.hid->unplug(kPath);
  REQUIRE(comesTrue([&] { return !scene.read().rendersForce; }));
  scene.hid->plug(spaceMouse());
  REQUIRE(comesTrue([&] { return scene.remarks.count("cannot be opened: Permission denied") == 1; }));
  CHECK(watch.elapsed_s() > 2.5);  // the system has time to set permissions
  std::this_thread::sleep_for(std::chrono::milliseconds(1200));
  CHECK(scene.remarks.size() == 2);
  scene.hid->deny(kPath, false);
  CHECK(comesTrue([&] { return scene.read().rendersForce; }));
}

TEST_CASE("a device that falls silent during a push stops the hand") {
  Scene scene;
  scene.send({pushed({1, 0, 0})});
  scene.go(50);
  REQUIRE(comesTrue([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(4));  // slow, so that it does not reach a stop meanwhile
    const DVec3 before = scene.read().position;
    return glm::distance(scene.go(2).position, before) < 1e-4;
  }));
  scene.go(200);
  const DVec3 rest = scene.read().position;
  CHECK(rest.x > 1);
  CHECK(rest.x < 0.5 * kTouchWorkspace_mm.x - 5);  // no stop holds it
  CHECK(glm::distance(scene.go(200).position, rest) < 0.01);
}

TEST_CASE("the sticks of a DualSense steer the hand") {
  const std::string pad = "/dev/hidraw5";
  Scene scene(DVec3(0), dualSense());
  Report report(64, 0);
  report[0] = 1;
  for (std::size_t k = 1; k <= 4; ++k) report[k] = 128 + 8;  // a worn stick, within the dead zone
  report[8] = 0x28;
  scene.hid->report(pad, report);
  REQUIRE(comesTrue([&] { return scene.read().buttons == 1; }));
  CHECK(glm::length(scene.go(300).position) < 0.01);
  report[4] = 0;  // the right stick, pushed away
  report[8] = 0x48;
  scene.hid->report(pad, report);
  REQUIRE(comesTrue([&] { return scene.read().buttons == 2; }));
  CHECK(scene.go(200).position.z < -10);
}

TEST_CASE("a device that cannot be opened is an error, and an open device closes promptly") {
  const auto hid = std::make_shared<FakeHid>();
  Remarks remarks;
  CHECK_THROWS_AS(HidDevice(hid, spaceMouse(), DVec3(0), remarks.sink()), Error);
  hid->plug(spaceMouse());
  const Stopwatch watch;
  { HidDevice device(hid, spaceMouse(), DVec3(0), remarks.sink()); }
  {
    HidDevice device(hid, spaceMouse(), DVec3(0), remarks.sink());
    hid->unplug(kPath);
    REQUIRE(comesTrue([&] { return remarks.size() == 1; }));
  }
  CHECK(watch.elapsed_s() < 15);
  CHECK(hid->opened() == 0);
}

TEST_CASE("in a session a steady push comes to rest on the surface, also at low rates and on stiff surfaces") {
  Scene scene({0, 0, 25}, spaceMouse(), false);
  SphereContact sphere(20);
  double rate_Hz = 1000, stiffness_N_per_mm = 0.8;
  SUBCASE("the default") {}
  SUBCASE("250 ticks per second") {
    rate_Hz = 250;
    stiffness_N_per_mm = 1.5;
  }
  SUBCASE("a stiff surface") { stiffness_N_per_mm = 2; }
  ServoLoop loop(*scene.device, sphere, ForceLaw({.stiffness_N_per_mm = stiffness_N_per_mm}, {}),
                 {.rate_Hz = rate_Hz, .duration_s = 4});
  double largest_N = 0, smallest_N = 10, earlier_s = -1;
  std::uint8_t mark = 0;
  const ServoResult result = loop.run([&](const TraceRow& row) {
    // The push must be repeated, and is received by another thread: a button report after it is the marker.
    if (row.time_s - earlier_s > 0.05) {
      earlier_s = row.time_s;
      mark ^= 1;
      scene.hid->report(kPath, pushed({0, 0, -0.9}));
      scene.hid->report(kPath, {3, mark});
      REQUIRE(comesTrue([&] { return scene.device->read(row.time_s).buttons == mark; }));
    }
    if (row.time_s < 3) return;
    largest_N = std::max(largest_N, row.force_N.z);
    smallest_N = std::min(smallest_N, row.force_N.z);
  });
  CHECK(result.trace().rows.back().contact);
  CHECK(smallest_N > 2);
  CHECK(largest_N < 1.1 * smallest_N);
}

TEST_CASE("a session with a 3D mouse survives an unplugging without a missed answer" * kClock) {
  Scene scene({0, 0, 20.1}, spaceMouse(), false);  // near enough for a slow machine
  SphereContact sphere(20);
  ServoLoop loop(*scene.device, sphere, ForceLaw({}, {}), {.duration_s = 2, .realtime = true});
  std::jthread hand([&](const std::stop_token& stop) {
    const Stopwatch watch;
    for (bool plugged = true; !stop.stop_requested();) {
      if (plugged && watch.elapsed_s() > 1) {
        scene.hid->unplug(kPath);
        plugged = false;
      }
      scene.hid->report(kPath, pushed({0, 0, -0.9}));
      std::this_thread::sleep_for(std::chrono::milliseconds(8));
    }
  });
  const ServoResult result = loop.run();
  CHECK(!result.deviceFailed);
  CHECK(result.trace().rows.back().contact);
  CHECK(scene.remarks.count("was unplugged") == 1);
  CHECK(result.trace().rows.back().hip == result.trace().rows[result.trace().rows.size() - 10].hip);
}

}  // namespace palpate::hid_device_test
