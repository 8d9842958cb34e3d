// Validation of the tests' GPU: PALPATE_TESTS_VALIDATE is "core" (the default: core and synchronisation validation),
// "full" (GPU-assisted validation as well, which takes a software driver minutes), or "0".
#pragma once

#include <doctest/doctest.h>

#include <cstdlib>
#include <string>

#include "engine/gpu/instance.hpp"

namespace palpate {

inline Validation askedValidation() {
  const char* asked = std::getenv("PALPATE_TESTS_VALIDATE");
  const std::string level = asked ? asked : "core";
  REQUIRE_MESSAGE((level == "full" || level == "core" || level == "0"), "PALPATE_TESTS_VALIDATE is " << level);
  return level == "full" ? Validation::full : level == "core" ? Validation::core : Validation::off;
}

/// For tests that do not need shader accesses checked.
inline Validation askedCoreValidation() {
  return askedValidation() == Validation::off ? Validation::off : Validation::core;
}

}  // namespace palpate
