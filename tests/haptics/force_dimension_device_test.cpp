#include "haptics/devices/force_dimension_device.hpp"

#include <limits>

#include "engine/core/error.hpp"
#include "haptics/servo_loop.hpp"
#include "tests/fake_devices/fake_driver.hpp"
#include "tests/haptics/contact_doubles.hpp"

namespace palpate::force_dimension_device_test {
namespace {

const char* const kPressing = "0,0,26,0\n0.1,0,26,0\n0.4,0,18,0\n";

ServoResult feel(double duration_s = 0.6) {
  ForceDimensionDevice device;
  SphereContact sphere(20);
  SteppedClock clock;
  ServoLoop loop(device, sphere, ForceLaw({.stiffness_N_per_mm = 0.4}, {}),
                 {.duration_s = duration_s, .realtime = true, .clock = &clock});
  return loop.run();
}

}  // namespace

TEST_CASE("an omega presses on a sphere in the model's axes and millimetres") {
  const FakeDriver driver("fake_dhd", "", kPressing);
  const ServoResult result = feel();
  CHECK_FALSE(result.deviceFailed);
  REQUIRE(result.trace().rows.back().contact);
  CHECK(result.trace().rows.back().force_N.y > 0.2);
  const FakeNote note = driver.note();
  CHECK(note.mostForce_N > 0.2);
  CHECK(driver.lastForce_N() == DVec3(0));
  CHECK(note.enabled == 0);
  CHECK(note.closed == 1);
}

TEST_CASE("positions and forces of a Force Dimension device keep their axes") {
  const FakeDriver driver("fake_dhd", "", "0,1.1,2.2,3.3\n");
  ForceDimensionDevice device;
  const DeviceState state = device.read(0);
  REQUIRE(state.ok);
  CHECK(glm::distance(state.position, DVec3(1.1, 2.2, 3.3)) < 1e-9);
  CHECK(device.write({0.1, 0.2, 0.3}));
  CHECK(driver.lastForce_N() == DVec3(0.1, 0.2, 0.3));
  CHECK(device.write({30, 0, 0}));
  CHECK(driver.lastForce_N() == DVec3(12, 0, 0));
  CHECK_FALSE(device.write({std::numeric_limits<double>::infinity(), 0, 0}));
  CHECK(driver.lastForce_N() == DVec3(0));
  device.emergencyStop();
  CHECK(device.write({0.1, 0.2, 0.3}));
  CHECK(driver.lastForce_N() == DVec3(0));
  CHECK(device.facts().model == "omega.3");
  CHECK(device.facts().driver == "3.17.6.0");
}

TEST_CASE("a Force Dimension device tells its serial number, for which its user's choices are remembered") {
  {
    const FakeDriver driver("fake_dhd");
    CHECK(ForceDimensionDevice().facts().serial == "40123");
  }
  const FakeDriver driver("fake_dhd", "fault serial");
  CHECK(ForceDimensionDevice().facts().serial == "");
}

TEST_CASE("faults of a Force Dimension device are reported with a reason") {
  SUBCASE("no device") {
    const FakeDriver driver("fake_dhd", "fault init");
    CHECK_THROWS_WITH_AS(ForceDimensionDevice{},
                         doctest::Contains("device 0 cannot be opened: no device found; check cable"), Error);
  }
  SUBCASE("another program uses it") {
    const FakeDriver driver("fake_dhd");
    const ForceDimensionDevice first;
    CHECK_THROWS_WITH_AS(ForceDimensionDevice{}, doctest::Contains("device already open"), Error);
  }
  SUBCASE("it disappears during a touch") {
    const FakeDriver driver("fake_dhd", "fault error 0 0.45", kPressing);
    const ServoResult result = feel();
    CHECK(result.deviceFailed);
    CHECK(result.fault == "omega.3: communication error; check cable and power of the device, and start again");
    CHECK(result.trace().rows.back().force_N == DVec3(0));
    CHECK(driver.note().mostForce_N > 0.1);
  }
  SUBCASE("a position that is not a number") {
    const FakeDriver driver("fake_dhd", "fault nan 0 0.45", kPressing);
    const ServoResult result = feel();
    CHECK(result.deviceFailed);
    CHECK(result.fault.find("a position that is not a number") != std::string::npos);
    CHECK(driver.lastForce_N() == DVec3(0));
  }
}

}  // namespace palpate::force_dimension_device_test
