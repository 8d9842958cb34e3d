// The GPU that tests run on, with every validation there is. One device serves a whole test program, since making one
// costs more than most tests; a test that ends with a validation message fails.
#pragma once

#include <doctest/doctest.h>

#include "engine/gpu/device.hpp"

namespace palpate {

class GpuFixture {
 public:
  ~GpuFixture() {
    device.waitIdle();
    CHECK_MESSAGE(device.instance().messages().take().empty(), "validation messages");
  }

 private:
  static Device& shared() {
    static Device device({.gpu = "", .validate = true});
    return device;
  }

 protected:
  Device& device = shared();
};

}  // namespace palpate
