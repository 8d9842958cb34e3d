// Hands that press on a soft body on the CPU.
#include "tests/matter/press_truths.hpp"

namespace palpate::soft_press_test {

TEST_CASE("pressing hands receive the momentum that the body loses") { checkPressMomentum(softOnCpu(), 200); }

TEST_CASE("random pressing hands gain no energy from a soft body") { checkPressEnergy(softOnCpu(), 600); }

TEST_CASE("only the side of a sheet that faces the hand is pressed") { checkPressedSide(softOnCpu()); }

TEST_CASE("a press moves only the nodes within its reach") { checkPressLocality(softOnCpu()); }

TEST_CASE("the presses of one hand together stay below the hand's maximum force") { checkMostOfHand(softOnCpu(), 120); }

TEST_CASE("presses that are not finite, or that pull, have no effect") { checkHostilePresses(softOnCpu()); }

TEST_CASE("presses give the same results bit by bit with one thread and with three, also after a reset") {
  checkSamePressedBytes(softOnCpu(1), softOnCpu(3), 30);
}

}  // namespace palpate::soft_press_test
