// A session through a driver's fake: a hand presses a stylus onto a sphere.
#pragma once

#include "haptics/servo_loop.hpp"
#include "tests/fake_devices/fake_driver.hpp"
#include "tests/haptics/contact_doubles.hpp"

namespace palpate {

/// From outside down onto the sphere's pole, 2 mm deep, and still there at the end.
inline const char* const kPressing = "0,0,26,0\n0.1,0,26,0\n0.4,0,18,0\n";

inline ForceLaw softLaw() { return ForceLaw({.stiffness_N_per_mm = 0.4}, {}); }

/// Ticks of the session equal ticks of the driver, however rarely the driver runs.
inline ServoResult pressed(HapticDevice& device, double duration_s = 0.6) {
  SphereContact sphere(20);
  SteppedClock clock;
  return ServoLoop(device, sphere, softLaw(), {.duration_s = duration_s, .realtime = true, .clock = &clock}).run();
}

/// Opened once, and closed without a force.
inline void checkClosed(const FakeStylus& stylus) {
  const FakeNote note = stylus.note();
  CHECK(note.threadFaults == 0);
  CHECK(note.frameFaults == 0);
  CHECK(note.opened == 1);
  CHECK(note.closed == 1);
  CHECK(note.enabled == 0);  // forces were on, and are off again
  CHECK(stylus.lastForce_N() == DVec3(0));
}

}  // namespace palpate
