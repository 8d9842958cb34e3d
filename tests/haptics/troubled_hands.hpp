// Hands on a sphere whose devices fail, are lifted and clutched at a test's command.
#pragma once

#include <doctest/doctest.h>

#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "haptics/path.hpp"
#include "haptics/servo_loop.hpp"
#include "tests/haptics/contact_doubles.hpp"
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
class TroubledDevice final : public HapticDevice {
 public:
  explicit TroubledDevice(Path path) : path_(std::move(path)) {}
  std::string_view name() const override { return "troubled"; }
  DeviceLimits limits() const override { return {.buttons = 2}; }
  bool paces() const override { return pacesItself; }
  DeviceState read(double time_s) noexcept override {
    now_s_ = time_s;
    const bool clutched = time_s >= clutchedFrom_s && time_s < clutchedTo_s;
    return {.position = path_.at(time_s),
            .buttons = clutched ? kClutchButton : 0,
            .putDown = std::abs(time_s - putDownAt_s) < 1e-9,
            .rendersForce = !(time_s >= mutedFrom_s && time_s < mutedTo_s),
            .ok = time_s < failsReadAt_s};
  }
  bool write(const DVec3& force_N) noexcept override {
    last_N = force_N;
    most_N = std::max(most_N, glm::length(force_N));
    return now_s_ < failsWriteAt_s;
  }
  void emergencyStop() noexcept override {}
  std::string faultText() const override { return text; }

  bool pacesItself = false;
  double failsReadAt_s = 1e9, failsWriteAt_s = 1e9, putDownAt_s = -1;
  double clutchedFrom_s = 1e9, clutchedTo_s = 1e9, mutedFrom_s = 1e9, mutedTo_s = 1e9;
  std::string text;
  DVec3 last_N{9};
  double most_N = 0;

 private:
  Path path_;
  double now_s_ = 0;
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
  std::ifstream in(folder / "trace.csv", std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline double mostOf(const Trace& trace) { return summarize(trace).peakForce_N; }

}  // namespace palpate
