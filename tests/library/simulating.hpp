// For cases that need scenes of matter.
#pragma once

#include <doctest/doctest.h>
#include <palpate/palpate.h>

namespace palpate {

inline bool canSimulate() {
  if (pp_can_simulate()) return true;
  MESSAGE("skipped: this palpate was built without PALPATE_SIMULATION");
  return false;
}

}  // namespace palpate
