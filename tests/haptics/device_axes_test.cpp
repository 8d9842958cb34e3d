// The axes of a device, and the device with the axes and the stiffness of its user.
#include <doctest/doctest.h>

#include <set>

#include "haptics/devices/personal_device.hpp"
#include "tests/haptics/device_doubles.hpp"
#include "tests/near.hpp"

namespace palpate::device_axes_test {
namespace {

/// A device at a position, with an orientation.
struct Held {
  explicit Held(const char* axes, double most_N_per_mm = std::numeric_limits<double>::infinity()) {
    auto resting = std::make_unique<ScriptedDevice>(
        [this](double) -> DeviceState {
          return {.position = {1, 2, 3}, .turn = turn, .ok = true};
        },
        DeviceLimits{.mostStiffness_N_per_mm = 2});
    inner = resting.get();
    device.emplace(std::move(resting), *DeviceAxes::named(axes), most_N_per_mm);
  }
  DQuat turn{1, 0, 0, 0};
  ScriptedDevice* inner = nullptr;
  std::optional<PersonalDevice> device;
};

}  // namespace

TEST_CASE("all 48 permutations of a device's axes have a name of their own, which is read back") {
  std::set<std::string> names;
  int mirrors = 0;
  for (int a = -3; a <= 3; ++a)
    for (int b = -3; b <= 3; ++b)
      for (int c = -3; c <= 3; ++c) {
        const auto axes = DeviceAxes::of({a, b, c});
        const bool isPermutation =
            a * b * c != 0 && std::abs(a) != std::abs(b) && std::abs(b) != std::abs(c) && std::abs(a) != std::abs(c);
        REQUIRE(axes.has_value() == isPermutation);
        if (!axes) continue;
        names.insert(axes->text());
        mirrors += axes->mirrors();
        CHECK(DeviceAxes::named(axes->text()) == axes);
        // The person's axis k is the device's axis of that number.
        for (int k = 0; k < 3; ++k) {
          const int axis = axes->numbers()[static_cast<std::size_t>(k)];
          DVec3 device(0), person(0);
          device[std::abs(axis) - 1] = axis > 0 ? 1 : -1;
          person[k] = 1;
          CHECK(axes->matrix() * device == person);
        }
      }
  CHECK(names.size() == 48);
  CHECK(mirrors == 24);
  CHECK(DeviceAxes::named("x,y,z")->isUnchanged());
}

TEST_CASE("texts that are not a permutation of axes are refused with an example") {
  for (const char* text :
       {"", "x", "x,y", "x,y,z,x", "x,x,z", "x,y,w", "x,,z", "-,y,z", "x;y;z", "xyz", "--x,y,z", "x,y,z,"})
    CHECK_FALSE(DeviceAxes::named(text));
  CHECK(axesComplaint("").empty());
  CHECK(axesComplaint("x,z,-y").empty());
  CHECK(axesComplaint("x,z").find("as in x,z,-y") != std::string::npos);
}

TEST_CASE("axes found on a device whose axes were changed before combine with those") {
  for (const char* first : {"x,z,-y", "-z,y,x", "y,-x,-z"})
    for (const char* second : {"x,-z,y", "z,x,y", "-x,y,z"}) {
      const DeviceAxes inner = *DeviceAxes::named(first), outer = *DeviceAxes::named(second);
      CHECK(outer.after(inner).matrix() == outer.matrix() * inner.matrix());
    }
}

TEST_CASE("a device has the axes of its user, and its forces point back") {
  Held held("x,-z,y");
  const DVec3 position = held.device->read(0).position;
  CHECK(position == DVec3(1, -3, 2));
  CHECK(held.device->write({4, 5, 6}));
  CHECK(held.inner->last_N == DVec3(4, 6, -5));
  // What the force does to the hand is the same in both axes.
  CHECK(glm::dot(position, DVec3(4, 5, 6)) == glm::dot(DVec3(1, 2, 3), held.inner->last_N));
}

TEST_CASE("the tip of a stylus points where the user sees it, with rotated and with mirrored axes") {
  for (const char* axes : {"x,-z,y", "-z,y,x", "-x,y,z", "x,z,y"}) {
    CAPTURE(axes);
    Held held(axes);
    held.turn = glm::angleAxis(0.7, glm::normalize(DVec3(1, 2, 3)));
    const DVec3 tip(0, 0, -1), inDevice = held.turn * tip;
    const DQuat turn = held.device->read(0).turn;
    CHECK(glm::length(turn) == near(1, 1e-12));
    CHECK(glm::distance(turn * tip, DeviceAxes::named(axes)->matrix() * inDevice) < 1e-12);
  }
}

TEST_CASE("a device is never stiffer than its user found stable, nor than its model bears") {
  CHECK(Held("x,y,z", 1.2).device->limits().mostStiffness_N_per_mm == 1.2);
  CHECK(Held("x,y,z", 3).device->limits().mostStiffness_N_per_mm == 2);
}

}  // namespace palpate::device_axes_test
