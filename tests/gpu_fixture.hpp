// The GPU of the tests. One device serves a whole test program, because creating one costs more than most tests; a
// validation message fails the test.
#pragma once

#include <doctest/doctest.h>

#include "engine/gpu/device.hpp"
#include "tests/asked_validation.hpp"
#include "tests/until_end.hpp"

namespace palpate {

/// With the requested validation.
inline Device& validatedDevice() {
  static Device& device = makeUntilEnd<Device>(DeviceOptions{.gpu = "", .validation = askedValidation()});
  return device;
}

/// For tests of code that other tests cover with validation, which would take a software driver many seconds per
/// shader.
inline Device& plainDevice() {
  static Device& device = makeUntilEnd<Device>(DeviceOptions{.gpu = "", .validation = Validation::off});
  return device;
}

/// Without GPU-assisted validation, which searches for every access of a shader.
inline Device& coreValidatedDevice() {
  if (askedValidation() != Validation::full) return validatedDevice();  // its pipelines already exist
  static Device& device = makeUntilEnd<Device>(DeviceOptions{.gpu = "", .validation = askedCoreValidation()});
  return device;
}

class GpuFixture {
 public:
  explicit GpuFixture(Device& validated = validatedDevice()) : device(validated) {}
  ~GpuFixture() {
    device.waitIdle();
    const auto messages = device.instance().messages().take();
    // Not as a check's message, which would also be built if the test has thrown and there are no messages.
    if (!messages.empty()) FAIL_CHECK(messages.size(), " validation messages, the first: ", messages.front());
  }

 protected:
  Device& device;
};

/// For cases with so much data, so many ticks or shader variants that a software driver would take half a minute under
/// GPU-assisted validation; other cases of the room run the same passes under it. `Fixture` passes its device to
/// GpuFixture.
template <class Fixture>
struct CoreValidated : Fixture {
  CoreValidated() : Fixture(coreValidatedDevice()) {}
};
using CoreGpuFixture = CoreValidated<GpuFixture>;

}  // namespace palpate
