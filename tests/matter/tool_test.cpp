// A ball between a hand and water.
#include "tests/matter/matter_truths.hpp"

namespace palpate {

TEST_CASE("a ball in water is pushed up by the weight of what it displaces") {
  for (const double radius_m : {0.03, 0.04}) {
    CAPTURE(radius_m);
    checkBuoyancy(onCpu(), radius_m, 400, 300);
  }
}

TEST_CASE("random hands get no energy out of water") { checkRandomHands(onCpu(), 2, 600); }

TEST_CASE("what a ball got is what water lost") { checkReactions(onCpu(), 300); }

}  // namespace palpate
