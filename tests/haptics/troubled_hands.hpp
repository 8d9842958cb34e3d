// Hands on a sphere whose devices fail, are lifted and clutched at a test's command.
#pragma once

#include <doctest/doctest.h>

#include <limits>
#include <string>
#include <vector>

#include "haptics/path.hpp"
#include "haptics/servo_loop.hpp"
#include "tests/content_of.hpp"
#include "tests/haptics/contact_doubles.hpp"
#include "tests/haptics/device_doubles.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate {

inline constexpr double kRadius = 50;

/// Outside while forces ramp up, down onto the pole, and along there.
inline Path left() { return Path({{0, {0, 0, 53}}, {0.55, {0, 0, 53}}, {0.7, {0, 0, 48.5}}, {1, {4, 3, 48.4}}}); }
/// To the sphere's side, in and out again.
inline Path right() {
  return Path({{0, {54, 0, 0}}, {0.6, {54, 0, 0}}, {0.75, {49, 0, 0}}, {0.9, {48, 5, 0}}, {1, {54, 5, 0}}});
}

/// A hand that follows a path, on a device with limits and faults set by the test.
class TroubledDevice : public ScriptedDevice {
 public:
  explicit TroubledDevice(const Path& path, const DeviceLimits& limits = {.buttons = 2}, std::string name = "troubled")
      : ScriptedDevice([this, path](double time_s) { return stateAt(path, time_s); }, limits, std::move(name)) {}
  TroubledDevice(const TroubledDevice&) = delete;
  TroubledDevice& operator=(const TroubledDevice&) = delete;
  bool paces() const override { return pacesItself; }

  bool pacesItself = false;
  double failsReadAt_s = 1e9, losesPositionAt_s = 1e9, putDownAt_s = -1;
  double clutchedFrom_s = 1e9, clutchedTo_s = 1e9, mutedFrom_s = 1e9, mutedTo_s = 1e9;

 private:
  DeviceState stateAt(const Path& path, double time_s) const {
    const bool clutched = time_s >= clutchedFrom_s && time_s < clutchedTo_s;
    DVec3 position = path.at(time_s);
    if (time_s >= losesPositionAt_s) position.y = std::numeric_limits<double>::quiet_NaN();
    return {.position = position,
            .buttons = clutched ? kClutchButton : 0,
            .putDown = std::abs(time_s - putDownAt_s) < 1e-9,
            .rendersForce = !(time_s >= mutedFrom_s && time_s < mutedTo_s),
            .ok = time_s < failsReadAt_s};
  }
};

inline const ServoOptions kSession{.duration_s = 1};
inline const HandOptions kUnbraked{.passivity = PassivityMode::off};

inline ServoResult alone(HapticDevice& device, ServoOptions options = kSession) {
  SphereContact sphere(kRadius);
  return ServoLoop(device, sphere, ForceLaw({}, {}), options, kUnbraked).run();
}

inline SessionHand handOf(HapticDevice& device) {
  return {.device = device, .law = ForceLaw({}, {}), .options = kUnbraked};
}

inline ServoResult together(const std::vector<HapticDevice*>& devices, ServoOptions options = kSession) {
  SharedSphere sphere(devices.size());
  std::vector<SessionHand> hands;
  for (HapticDevice* device : devices) hands.push_back(handOf(*device));
  ServoResult result = ServoLoop(sphere, hands, options).run();
  REQUIRE(result.hands.size() == devices.size());
  CHECK(static_cast<std::size_t>(sphere.queries) >= result.trace().rows.size() - 1);
  CHECK(static_cast<std::size_t>(sphere.queries) <= result.trace().rows.size());  // one for all hands
  return result;
}

inline std::string csvOf(const Trace& trace) {
  const ScratchFolder folder;
  writeTraceCsv(folder / "trace.csv", trace);
  return contentOf(folder / "trace.csv");
}

inline double mostOf(const Trace& trace) { return summarize(trace).peakForce_N; }

}  // namespace palpate
