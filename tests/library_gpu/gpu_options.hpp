#pragma once

#include <cstdlib>

#include "tests/library/ball.hpp"

namespace palpate {

/// On the GPU that the tests run on.
inline pp_session_options gpuOptions() {
  pp_session_options options = cpuOptions();
  const char* const named = std::getenv("PALPATE_GPU");
  options.gpu = named ? named : "0";
  return options;
}

}  // namespace palpate
