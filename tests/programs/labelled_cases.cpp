// A test program with a case of each kind, for tests/core/labels_linux_test.cpp.
#include "tests/labels.hpp"

#include <cstdlib>

namespace palpate {

namespace {

bool shallFail(const char* what) { return std::getenv(what) != nullptr; }

}  // namespace

TEST_CASE("plain") { CHECK(!shallFail("FAIL_PLAIN")); }

TEST_CASE("of the full tier" * kFull) { CHECK(true); }

TEST_CASE("more in the full tier" * kMoreInFull) {
  const int repetitions = byTier(3, 30);
  CHECK(repetitions >= 3);
  MESSAGE("repetitions: ", repetitions);
}

TEST_CASE("measures a clock, late once" * kClock) {
  static int tries = 0;
  CHECK((++tries > 1 || !shallFail("FAIL_ONCE")));
}

TEST_CASE("measures a clock, always late" * kClock) { CHECK(!shallFail("FAIL_ALWAYS")); }

TEST_SUITE_BEGIN(kPortable);

TEST_CASE("on every driver") {
  CHECK(!shallFail("FAIL_PORTABLE"));
  MESSAGE("skipped: there is no such driver");
}

TEST_CASE("on every driver, of the full tier" * kFull) { CHECK(true); }

TEST_SUITE_END();

}  // namespace palpate
