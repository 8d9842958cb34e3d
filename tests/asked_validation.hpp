// How closely the tests' GPU is watched: PALPATE_TESTS_VALIDATE is "full", which it is without it, "core", for layers
// and drivers that GPU-assisted validation does not get on with, or "0", for a second run that is about something else.
#pragma once

#include <doctest/doctest.h>

#include <cstdlib>
#include <string>

#include "engine/gpu/validation.hpp"

namespace palpate {

inline Validation askedValidation() {
  const char* asked = std::getenv("PALPATE_TESTS_VALIDATE");
  const std::string level = asked ? asked : "full";
  REQUIRE_MESSAGE((level == "full" || level == "core" || level == "0"), "PALPATE_TESTS_VALIDATE is " << level);
  return level == "full" ? Validation::full : level == "core" ? Validation::core : Validation::off;
}

/// For tests of what a layer can see without looking into the shaders that run, which takes a software driver minutes.
inline Validation askedCoreValidation() {
  return askedValidation() == Validation::off ? Validation::off : Validation::core;
}

}  // namespace palpate
