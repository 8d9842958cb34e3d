// The GPU that tests run on. One device serves a whole test program, since making one costs more than most tests; a test
// that ends with a validation message fails.
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

class GpuFixture {
 public:
  ~GpuFixture() {
    device.waitIdle();
    const auto messages = device.instance().messages().take();
    CHECK_MESSAGE(messages.empty(), messages.size() << " validation messages, the first: " << messages.front());
  }

 protected:
  Device& device = validatedDevice();
};

}  // namespace palpate
