// The GPU that tests run on. One device serves a whole test program, since making one costs more than most tests; a
// test that ends with a validation message fails.
#pragma once

#include <doctest/doctest.h>

#include "engine/gpu/device.hpp"
#include "tests/asked_validation.hpp"
#include "tests/until_end.hpp"

namespace palpate {

/// Validated as the tests are asked to be.
inline Device& validatedDevice() {
  static Device& device = makeUntilEnd<Device>(DeviceOptions{.gpu = "", .validation = askedValidation()});
  return device;
}

/// For tests of what others test with validation, beside which a software driver would take many seconds for a shader.
inline Device& plainDevice() {
  static Device& device = makeUntilEnd<Device>(DeviceOptions{.gpu = "", .validation = Validation::off});
  return device;
}

/// Without GPU-assisted validation, which makes a search of every access of a shader.
inline Device& coreValidatedDevice() {
  if (askedValidation() != Validation::full) return validatedDevice();  // its pipelines are there already
  static Device& device = makeUntilEnd<Device>(DeviceOptions{.gpu = "", .validation = askedCoreValidation()});
  return device;
}

class GpuFixture {
 public:
  explicit GpuFixture(Device& validated = validatedDevice()) : device(validated) {}
  ~GpuFixture() {
    device.waitIdle();
    const auto messages = device.instance().messages().take();
    // Not as the message of a check, which is put together, too, where a test has thrown and there is none.
    if (!messages.empty()) FAIL_CHECK(messages.size(), " validation messages, the first: ", messages.front());
  }

 protected:
  Device& device;
};

/// For cases with so much data, so many ticks or shaders of so many kinds that a software driver would take half a
/// minute to search for each access: others of the same room run the same passes under GPU-assisted validation.
/// `Fixture` hands its device down to GpuFixture.
template <class Fixture>
struct CoreValidated : Fixture {
  CoreValidated() : Fixture(coreValidatedDevice()) {}
};
using CoreGpuFixture = CoreValidated<GpuFixture>;

}  // namespace palpate
