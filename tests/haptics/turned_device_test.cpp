#include "haptics/devices/turned_device.hpp"

#include <doctest/doctest.h>

#include <glm/gtc/matrix_transform.hpp>

#include "tests/haptics/device_doubles.hpp"

namespace palpate::turned_device_test {
TEST_CASE("a device moves along its user's view, and its forces are rotated back") {
  auto resting = std::make_unique<ScriptedDevice>([](double) -> DeviceState {
    return {.position = {11, 22, 33}, .ok = true};
  });
  ScriptedDevice& inner = *resting;
  TurnedDevice device(std::move(resting), {10, 20, 30});
  CHECK(device.read(0).position == DVec3(1, 2, 3));
  CHECK_FALSE(device.read(0).putDown);

  // Viewed along -x: right is -z, up is y, towards the eye is x.
  const glm::dmat3 fromRight(DVec3(0, 0, -1), DVec3(0, 1, 0), DVec3(1, 0, 0));
  device.setAxes(fromRight);
  const DeviceState turned = device.read(0);
  CHECK(turned.position == DVec3(3, 2, -1));
  CHECK(turned.putDown);  // no motion from the old position to the new one
  CHECK(glm::distance(turned.turn * DVec3(0, 0, 1), DVec3(1, 0, 0)) < 1e-12);
  CHECK_FALSE(device.read(0).putDown);
  device.setAxes(fromRight);
  CHECK_FALSE(device.read(0).putDown);

  CHECK(device.write({0.5, 0.1, 0.2}));  // the device's z points to the eye
  CHECK(inner.last_N == DVec3(-0.2, 0.1, 0.5));
}

}  // namespace palpate::turned_device_test
