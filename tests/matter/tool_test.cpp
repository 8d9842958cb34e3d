// A ball between a hand and water.
#include "tests/labels.hpp"
#include "tests/matter/matter_truths.hpp"

namespace palpate::tool_test {

TEST_CASE("a ball in water has the buoyancy of the displaced water" * kMoreInFull) {
  for (const double radius_m : byTier<std::vector<double>>({0.03}, {0.03, 0.04})) {
    CAPTURE(radius_m);
    checkBuoyancy(onCpu(), radius_m, 400, 300);
  }
}

TEST_CASE("random hands gain no energy from water and sand, even with a force gain" * kMoreInFull) {
  checkRandomHands(onCpu(), Matter::water, 1, 1, byTier(300, 600));
  for (const Matter matter : {Matter::water, Matter::sand})
    checkRandomHands(onCpu(), matter, 50, byTier(1, 2), byTier(300, 400));
}

TEST_CASE("a hand's energy matches its force, also while the gain changes") { checkPortEnergy(onCpu(), 300, 1e-9); }

TEST_CASE("viscous water resists the rotation of a ball") { checkTorque(onCpu(), 400, 0.4, 0.6); }

TEST_CASE("a ball receives the momentum that the water loses") { checkReactions(onCpu(), 300); }

}  // namespace palpate::tool_test
