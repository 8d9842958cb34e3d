#include "haptics/devices/rumble.hpp"

#include <doctest/doctest.h>

#include <atomic>
#include <limits>
#include <thread>

#include "engine/core/error.hpp"
#include "haptics/devices/path_device.hpp"
#include "haptics/devices/rumbling_device.hpp"
#include "haptics/servo_loop.hpp"
#include "tests/haptics/contact_doubles.hpp"
#include "tests/haptics/device_doubles.hpp"
#include "tests/haptics/fake_hid.hpp"

namespace palpate::rumble_test {
namespace {

const std::string kPad = "/dev/hidraw5";

bool isSilent(const Report& report) { return report.at(3) == 0 && report.at(4) == 0; }

struct Scene {
  std::shared_ptr<FakeHid> hid = std::make_shared<FakeHid>();
  Remarks remarks;
  std::unique_ptr<Rumble> rumble;

  explicit Scene(double full_N = kTouchPeakForce_N) {
    hid->plug(dualSense());
    rumble = std::make_unique<Rumble>(hid, dualSense(), remarks.sink(), full_N);
  }
  /// Repeats the force like a servo loop, until `condition` is true.
  bool telling(const DVec3& force_N, const auto& condition) {
    return comesTrue([&] {
      rumble->setForce(force_N);
      return condition();
    });
  }
  bool ranAndStopped() {
    const auto sent = hid->sent(kPad);
    return !sent.empty() && isSilent(sent.back());
  }
  bool runs() {
    const auto sent = hid->sent(kPad);
    return !sent.empty() && sent.back()[4] > 0;
  }
};

}  // namespace

TEST_CASE("a contact starts with a tap, and the hum grows with the force") {
  RumbleShape shape;
  CHECK(shape.at(0, 0, 0) == RumbleMotors{});
  const RumbleMotors begin = shape.at(0.01, 0.1, 1);
  CHECK(begin.weak > 100);
  CHECK(begin.strong > 20);
  CHECK(shape.at(0.04, 0.1, 1).weak > 100);
  const RumbleMotors later = shape.at(0.2, 0.1, 1);
  CHECK(later.weak == 0);
  CHECK(later.strong == begin.strong);
  CHECK(shape.at(0.3, 0.5, 1).strong > later.strong + 40);
  CHECK(shape.at(0.4, 1, 1).strong == 200);
  CHECK(shape.at(0.5, 7, 1).strong == 200);
  CHECK(shape.at(0.6, 0, 1) == RumbleMotors{});
  CHECK(shape.at(0.7, 1, 2).weak == 255);  // a hard impact
}

TEST_CASE("a contact between two reports still gives a tap, and repeated contacts do not overlap") {
  RumbleShape shape;
  CHECK(shape.at(0, 0, 3).weak > 0);
  CHECK(shape.at(0.03, 0, 4).weak > 0);
  CHECK(shape.at(0.06, 0, 4).weak == 0);  // the touch in between did not prolong it
}

TEST_CASE("the motors run with the force and stop with it") {
  Scene scene;
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  CHECK(scene.hid->sent(kPad).empty());  // without touch there are no reports
  REQUIRE(scene.telling({0, 2, 0}, [&] { return scene.runs(); }));
  const auto first = scene.hid->sent(kPad).front();
  CHECK(first.size() == 48);
  CHECK(first[0] == 2);
  CHECK(first[3] > 0);  // the tap
  CHECK(scene.telling({0, 2, 0}, [&] { return scene.hid->sent(kPad).back()[3] == 0 && scene.runs(); }));
  CHECK(scene.telling({0, 0, 0}, [&] { return scene.ranAndStopped(); }));
}

TEST_CASE("the motors stop if no force is written any more") {
  Scene scene;
  REQUIRE(scene.telling({3, 0, 0}, [&] { return scene.runs(); }));
  CHECK(comesTrue([&] { return scene.ranAndStopped(); }));
}

TEST_CASE("the strongest hum is at the device's maximum force, or at a Touch's if a device has no limit") {
  double full_N = 8;
  std::uint8_t expected = 64;  // between 24 and 200, in steps of 8
  SUBCASE("a stronger device") {}
  SUBCASE("a script without a force limit") {
    full_N = std::numeric_limits<double>::infinity();
    expected = 128;
  }
  Scene scene(full_N);
  CHECK(scene.telling({2, 0, 0}, [&] { return scene.runs() && scene.hid->sent(kPad).back()[4] == expected; }));
}

TEST_CASE("a force that is not a number causes no rumble") {
  Scene scene;
  for (const double wrong : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    const Stopwatch watch;
    scene.telling({wrong, 0, 0}, [&] { return watch.elapsed_s() > 0.1; });
  }
  CHECK(scene.hid->sent(kPad).empty());
}

TEST_CASE("the last report of a session stops the motors") {
  Scene scene;
  REQUIRE(scene.telling({3, 0, 0}, [&] { return scene.runs(); }));
  scene.rumble.reset();
  CHECK(isSilent(scene.hid->sent(kPad).back()));
  CHECK(scene.hid->opened() == 0);
}

TEST_CASE("an emergency stop silences the gamepad at once and for good") {
  Scene scene;
  REQUIRE(scene.telling({3, 0, 0}, [&] { return scene.runs(); }));
  scene.rumble->stop();
  const auto fromSignal = scene.hid->sent(kPad, true);
  REQUIRE(fromSignal.size() == 1);
  CHECK(isSilent(fromSignal[0]));
  CHECK(fromSignal[0][1] == 0x03);
  REQUIRE(scene.telling({3, 0, 0}, [&] { return scene.ranAndStopped(); }));
  const std::size_t so_far = scene.hid->sent(kPad).size();
  for (int i = 0; i < 100; ++i) {
    scene.rumble->setForce({3, 0, 0});
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  CHECK(scene.hid->sent(kPad).size() == so_far);
}

TEST_CASE("reports are sent at a limited rate, however the force changes") {
  Scene scene;
  const Stopwatch watch;
  int i = 0;
  CHECK(comesTrue([&] {
    scene.rumble->setForce({i++ % 2 * 3.0, 0, 0});
    return watch.elapsed_s() > 0.5 && scene.hid->sent(kPad).size() > 3;
  }));
  const auto sent = static_cast<double>(scene.hid->sent(kPad).size());
  CHECK(sent < 120 * watch.elapsed_s());
}

TEST_CASE("an unplugged gamepad rumbles again after reconnection, and a stop without one does no harm") {
  Scene scene;
  REQUIRE(scene.telling({3, 0, 0}, [&] { return scene.runs(); }));
  scene.hid->unplug(kPad);
  REQUIRE(
      scene.telling({1, 0, 0}, [&] { return scene.remarks.count("was unplugged: there is no rumble until") == 1; }));
  const std::size_t before = scene.hid->sent(kPad).size();
  scene.hid->plug(dualSense());
  CHECK(scene.telling({1, 0, 0}, [&] { return scene.hid->sent(kPad).size() > before && scene.runs(); }));
  CHECK(scene.remarks.count("is back") == 1);
  scene.hid->unplug(kPad);
  REQUIRE(scene.telling({3, 0, 0}, [&] { return scene.remarks.count("was unplugged") == 2; }));
  scene.rumble->stop();
  CHECK(scene.hid->sent(kPad, true).empty());
}

TEST_CASE("a gamepad beside any device rumbles with the force actually written") {
  Scene scene;
  FakeHid* const hid = scene.hid.get();
  bool renders = true;
  auto flaky = std::make_unique<ScriptedDevice>(
      [&](double) -> DeviceState { return {.rendersForce = renders, .ok = true}; }, DeviceLimits{}, "flaky");
  flaky->text = "no fault";
  ScriptedDevice& inner = *flaky;
  RumblingDevice device(std::move(flaky), std::move(scene.rumble));
  const auto last = [&] { return hid->sent(kPad).empty() ? Report(48, 0) : hid->sent(kPad).back(); };
  const auto ticks = [&](const auto& condition) {
    return comesTrue([&] {
      device.read(0);
      CHECK(device.write({2, 0, 0}));
      return condition();
    });
  };
  REQUIRE(ticks([&] { return last()[4] > 0; }));
  CHECK(inner.last_N == DVec3(2, 0, 0));
  CHECK(device.name() == "flaky");
  CHECK(device.faultText() == "no fault");
  renders = false;
  REQUIRE(ticks([&] { return isSilent(last()); }));
  device.emergencyStop();
  CHECK(inner.stopped);
  CHECK(hid->sent(kPad, true).size() == 1);
}

TEST_CASE("the gamepad is silent after a session, however it ends") {
  Scene scene;
  RumblingDevice device(std::make_unique<PathDevice>(Path({{0, {0, 0, 8}}, {1, {0, 0, 8}}})), std::move(scene.rumble));
  SphereContact sphere(10);
  std::atomic<bool> stop = false;
  ServoLoop loop(device, sphere, ForceLaw({}, {}), {.endless = true, .realtime = true, .stop = &stop});
  std::jthread session([&] { loop.run(); });
  CHECK(comesTrue([&] { return scene.hid->sent(kPad).size() > 1; }));
  stop = true;
  session.join();
  CHECK(comesTrue([&] { return isSilent(scene.hid->sent(kPad).back()); }));
}

}  // namespace palpate::rumble_test
