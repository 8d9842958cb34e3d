// Hands that press on a soft body on the CPU.
#include "tests/matter/press_truths.hpp"

namespace palpate::soft_press_test {

TEST_CASE("what hands that press got is what the body lost") { checkPressMomentum(softOnCpu(), 200); }

TEST_CASE("random hands that press get no energy out of a soft body") { checkPressEnergy(softOnCpu(), 600); }

TEST_CASE("of a sheet only the side is pressed that faces the hand") { checkPressedSide(softOnCpu()); }

TEST_CASE("a press moves what is within its reach and nothing else") { checkPressLocality(softOnCpu()); }

TEST_CASE("presses of one hand are no more together than it bears") { checkMostOfHand(softOnCpu(), 120); }

TEST_CASE("presses that are no numbers or that pull do nothing") { checkHostilePresses(softOnCpu()); }

TEST_CASE("presses give the same bytes with one thread and with three, and after the scene was begun again") {
  checkSamePressedBytes(softOnCpu(1), softOnCpu(3), 30);
}

}  // namespace palpate::soft_press_test
