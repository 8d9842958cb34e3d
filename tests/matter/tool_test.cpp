// A ball between a hand and water.
#include "tests/labels.hpp"
#include "tests/matter/matter_truths.hpp"

namespace palpate::tool_test {

TEST_CASE("a ball in water is pushed up by the weight of what it displaces" * kMoreInFull) {
  for (const double radius_m : byTier<std::vector<double>>({0.03}, {0.03, 0.04})) {
    CAPTURE(radius_m);
    checkBuoyancy(onCpu(), radius_m, 400, 300);
  }
}

TEST_CASE("random hands get no energy out of water and sand, with a gain of their forces, too" * kMoreInFull) {
  checkRandomHands(onCpu(), Matter::water, 1, 1, byTier(300, 600));
  for (const Matter matter : {Matter::water, Matter::sand})
    checkRandomHands(onCpu(), matter, 50, byTier(1, 2), byTier(300, 400));
}

TEST_CASE("the energy of a hand is that of the force that it gets, while the gain changes") {
  checkPortEnergy(onCpu(), 300, 1e-9);
}

TEST_CASE("a ball that turns in viscous water is held back by it") { checkTorque(onCpu(), 400, 0.4, 0.6); }

TEST_CASE("what a ball got is what water lost") { checkReactions(onCpu(), 300); }

}  // namespace palpate::tool_test
