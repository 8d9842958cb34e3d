// A library without PALPATE_SIMULATION.
#include <doctest/doctest.h>
#include <palpate/palpate.h>

#include "tests/library/ball.hpp"

namespace palpate::no_matter_test {

TEST_CASE("a library built without PALPATE_SIMULATION opens no scene, and reports that") {
  CHECK(pp_can_simulate() == 0);
  pp_matter matter{};
  pp_session session{};
  for (const char* scene : {"water", "tank.json", "bunny.ply"}) {
    PP_CHECK_FAILS(pp_matter_open(scene, nullptr, &matter), PP_ERROR_UNSUPPORTED, "needs PALPATE_SIMULATION");
    PP_CHECK_FAILS(pp_session_open_matter(scene, nullptr, &session), PP_ERROR_UNSUPPORTED, "needs PALPATE_SIMULATION");
  }
}

}  // namespace palpate::no_matter_test
