#include <doctest/doctest.h>

#include "haptics/devices/guided_touch.hpp"
#include "haptics/devices/haply_device.hpp"
#include "haptics/devices/hid_device.hpp"
#include "haptics/devices/rumbling_device.hpp"
#include "haptics/devices/simulated_touch.hpp"
#include "haptics/devices/wrapped_device.hpp"
#include "haptics/servo_loop.hpp"
#include "tests/allocation_count.hpp"
#include "tests/fake_devices/fake_haply.hpp"
#include "tests/haptics/contact_doubles.hpp"
#include "tests/haptics/fake_hid.hpp"

namespace palpate::servo_allocation_test {
namespace {

/// Counts from the first read to the last write, including everything between ticks.
class CountingDevice final : public WrappedDevice {
 public:
  CountingDevice(const Path& path, double lastTick_s)
      : WrappedDevice(std::make_unique<SimulatedTouch>(path, WorkspaceMap{})), lastTick_s_(lastTick_s) {}
  DeviceState read(double time_s) noexcept override {
    counting = time_s < lastTick_s_;
    return WrappedDevice::read(time_s);
  }

 private:
  double lastTick_s_;
};

}  // namespace

TEST_CASE("no tick allocates memory") {
  CountingDevice device(Path({{0, {0, 0, 12}}, {0.05, {0, 0, 8}}, {0.1, {3, 0, 12}}}), 0.095);
  SphereContact sphere(10);
  bool realtime = true;
  SUBCASE("in real time") {}
  SUBCASE("in virtual time") { realtime = false; }
  HalfOverPlane plane(8.5);
  ContactQuery* query = &sphere;
  SUBCASE("with a tool of many points") {
    realtime = false;
    query = &plane;
  }
  SharedSphere shared(4, 10);
  SimulatedTouch others[3]{SimulatedTouch(Path({{0, {12, 0, 0}}, {0.05, {8, 0, 0}}}), {}),
                           SimulatedTouch(Path({{0, {0, 12, 0}}, {0.05, {0, 8, 0}}}), {}),
                           SimulatedTouch(Path({{0, {-12, 0, 0}}, {0.05, {-8, 0, 0}}}), {})};
  std::vector<SessionHand> hands{{.device = device, .law = ForceLaw({}, {})}};
  SUBCASE("of four hands") {
    realtime = false;
    query = &shared;
    for (SimulatedTouch& other : others) hands.push_back({.device = other, .law = ForceLaw({}, {})});
  }
  ServoLoop loop(*query, hands, {.duration_s = 0.1, .realtime = realtime});
  allocations = 0;
  const ServoResult result = loop.run();
  counting = false;
  CHECK(allocations == 0);
  REQUIRE(result.hands.size() == hands.size());
  for (const HandResult& hand : result.hands)
    if (!realtime) CHECK(summarize(hand.trace).contactTicks > 0);  // a busy machine may miss them

  counting = true;
  int* volatile kept = new int(7);  // volatile, so that no compiler removes it
  delete kept;
  counting = false;
  CHECK(allocations == 1);  // the counter counts
}

TEST_CASE("a tick of a 3D mouse with a rumbling gamepad allocates no memory, also while unplugged") {
  const auto hid = std::make_shared<FakeHid>();
  hid->plug(spaceMouse());
  hid->plug(dualSense());
  Remarks remarks;
  RumblingDevice device(std::make_unique<HidDevice>(hid, spaceMouse(), DVec3(0, 0, 12), remarks.sink()),
                        std::make_unique<Rumble>(hid, dualSense(), remarks.sink()));
  countedThread = std::this_thread::get_id();
  allocations = 0;
  bool rendered = true;
  for (int tick = 0; tick < 2000; ++tick) {
    if (tick == 1000) {
      hid->unplug("/dev/hidraw3");
      REQUIRE(comesTrue([&] { return !device.read(1).rendersForce; }));
    }
    counting = true;
    rendered = device.read(tick * 1e-3).rendersForce;
    device.write({0, 0, 1});
    counting = false;
  }
  countedThread = std::thread::id();
  CHECK(allocations == 0);
  CHECK(!rendered);
}

TEST_CASE("a tick of a drawn stroke allocates no memory") {
  GuidedTouch device({}, {0, 0, 300}, {.countsTicks = true, .catchesUp = true});
  for (int tick = 0; device.canDraw(); ++tick)
    device.draw({.place = {1e-3 * tick, 0, 0}, .outward = {0, 0, 1}, .toEye = {0, 0, 1}, .inward = 2});
  countedThread = std::this_thread::get_id();
  allocations = 0;
  counting = true;
  bool waits = false;
  for (int tick = 0; !waits && tick < 10'000; ++tick) {
    waits = device.read(1e-3 * tick).waits;
    device.feel(DVec3(0, 0, 2));
    device.write({0, 0, 1});
  }
  counting = false;
  countedThread = std::thread::id();
  CHECK(waits);
  CHECK(allocations == 0);
}

TEST_CASE("a tick of a Haply device allocates no memory, while its own thread speaks with the service") {
  const FakeHaply service({});
  HaplyDevice device({});
  countedThread = std::this_thread::get_id();
  allocations = 0;
  counting = true;
  bool rendered = false, written = true;
  for (int i = 0; i < 400; ++i) {
    rendered = device.read(0).rendersForce || rendered;
    written = device.write({0, 0.1, 0}) && written;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  counting = false;
  countedThread = std::thread::id();
  CHECK(allocations == 0);
  CHECK(rendered);
  CHECK(written);
  CHECK(service.commands().size() > 20);
}

}  // namespace palpate::servo_allocation_test
