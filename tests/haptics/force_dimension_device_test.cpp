#include "haptics/devices/force_dimension_device.hpp"

#include <limits>

#include "engine/core/error.hpp"
#include "tests/haptics/pressing_session.hpp"

namespace palpate::force_dimension_device_test {
TEST_CASE("an omega presses on a sphere in the model's axes and millimetres") {
  const FakeDriver driver("fake_dhd", "", kPressing);
  ServoResult result;
  {
    ForceDimensionDevice device;
    result = pressed(device);
  }
  CHECK_FALSE(result.deviceFailed);
  REQUIRE(result.trace().rows.back().contact);
  CHECK(result.trace().rows.back().force_N.y > 0.2);
  checkClosed(driver);
  CHECK(driver.note().mostForce_N > 0.2);
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

TEST_CASE("a Force Dimension device that cannot be opened is reported with a reason") {
  {
    INFO("no device");
    const FakeDriver driver("fake_dhd", "fault init");
    CHECK_THROWS_WITH_AS(ForceDimensionDevice{},
                         doctest::Contains("device 0 cannot be opened: no device found; check cable"), Error);
  }
  INFO("another program uses it");
  const FakeDriver driver("fake_dhd");
  const ForceDimensionDevice first;
  CHECK_THROWS_WITH_AS(ForceDimensionDevice{}, doctest::Contains("device already open"), Error);
}

}  // namespace palpate::force_dimension_device_test
