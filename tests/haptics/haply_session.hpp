// A session with a Haply device against a service in this process, over real sockets.
#pragma once

#include <doctest/doctest.h>

#include <functional>

#include "haptics/devices/haply_device.hpp"
#include "haptics/servo_loop.hpp"
#include "tests/fake_devices/fake_haply.hpp"
#include "tests/haptics/contact_doubles.hpp"
#include "tests/haptics/remarks.hpp"

namespace palpate {

constexpr double kHaplyStiffness_N_per_mm = 0.4, kHaplySphere_mm = 20;
/// Above the sphere, then 6 mm deep in it.
inline const std::vector<PathKey> kHaplyPressing{{0, {0, 26, 0}}, {0.2, {0, 26, 0}}, {0.4, {0, 14, 0}}};

struct HaplyFelt {
  ServoResult result;
  std::string said;
  std::vector<FakeHaply::Command> commands;
  double faultBegan_s = 0;

  /// Commands with a force that came after the first faulty state.
  std::vector<FakeHaply::Command> forcesAfterFault() const {
    std::vector<FakeHaply::Command> forces;
    for (const FakeHaply::Command& command : commands)
      if (command.afterFault && command.force_N != DVec3(0)) forces.push_back(command);
    return forces;
  }
};

/// A session with a service, both by one stepped clock.
inline HaplyFelt playHaply(FakeHaplyOptions fake, HaplyOptions options,
                           const std::function<ServoResult(HaplyDevice&, SteppedClock*)>& session) {
  SteppedClock clock;
  fake.clock = &clock;
  options.clock = &clock;
  const FakeHaply service(fake);
  Remarks remarks;
  options.say = remarks.sink();
  clock.hold();
  HaplyFelt felt;
  {
    HaplyDevice device(options);
    felt.result = session(device, &clock);
    clock.leave();
  }
  service.waitUntilLeft();
  CHECK(service.otherRequests() == std::vector<std::string>{});  // nothing is set on a device
  felt.said = remarks.text();
  felt.commands = service.commands();
  felt.faultBegan_s = service.faultBegan_s();
  return felt;
}

inline HaplyFelt feelHaply(const FakeHaplyOptions& fake, double duration_s, const HaplyOptions& options = {}) {
  return playHaply(fake, options, [&](HaplyDevice& device, SteppedClock* clock) {
    SphereContact sphere(kHaplySphere_mm, FakeHaply::kMiddle_mm);
    return ServoLoop(device, sphere, ForceLaw({.stiffness_N_per_mm = kHaplyStiffness_N_per_mm}, {}),
                     {.duration_s = duration_s, .realtime = true, .clock = clock})
        .run();
  });
}

inline double most_N(const std::vector<FakeHaply::Command>& commands, double from_s = 0, double to_s = 1e9) {
  double most = 0;
  for (const FakeHaply::Command& command : commands)
    if (command.time_s >= from_s && command.time_s < to_s) most = std::max(most, glm::length(command.force_N));
  return most;
}

}  // namespace palpate
