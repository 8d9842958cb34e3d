#include "tests/near.hpp"

#include <cstdint>
#include <limits>

namespace palpate::near_test {

TEST_CASE("a relative tolerance is a share of the value, however small the value is") {
  CHECK(1.02 == near(1.0, 0.0201));
  CHECK(0.98 == near(1.0, 0.0201));
  CHECK(1.03 != near(1.0, 0.02));
  CHECK(-5.09 == near(-5, 0.02));
  CHECK(5.0 != near(-5, 0.02));
  CHECK(5.05e-9 == near(5e-9, 0.02));
  CHECK(5.2e-9 != near(5e-9, 0.02));
  CHECK(102'000'000 == near(1e8, 0.021));
  CHECK(near(5, 0.02) == 5.05);
}

TEST_CASE("only zero is near zero: a tolerance has no absolute part") {
  CHECK(0.0 != near(0.005, 0.05));
  CHECK(0.0 != near(0.005, 0.99));
  CHECK(0.1 != near(0.33, 0.05));
}

TEST_CASE("an absolute tolerance is the same for every value, and its bounds are included") {
  CHECK(0.0 == within(0, 0));
  CHECK(0.5 == within(0, 0.5));
  CHECK(-0.5 == within(0, 0.5));
  CHECK(0.51 != within(0, 0.5));
  CHECK(1000.5 == within(1000, 0.5));
  CHECK(1000.6 != within(1000, 0.5));
}

TEST_CASE("single precision and whole numbers are compared in double precision") {
  CHECK(0.1F == near(0.1, 1e-7));
  CHECK(0.1F != near(0.1, 1e-9));
  CHECK(std::uint64_t{1'000'001} == within(1e6, 1));
  CHECK(-3 == within(-2, 1));
}

TEST_CASE("a value that is not a number equals nothing, and no value equals it") {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();
  CHECK(kNaN != near(1, 0.5));
  CHECK(kNaN != within(0, 1e300));
  CHECK(kNaN != within(kNaN, 1));
  CHECK(1.0 != within(kNaN, 1));
  CHECK(kInfinity != within(1, 1e300));
  CHECK(kInfinity != near(1, 0.5));
}

TEST_CASE("tolerances that would accept everything or nothing throw") {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();
  CHECK_THROWS_AS(near(0, 0.1), std::invalid_argument);
  CHECK_THROWS_AS(near(1, 1), std::invalid_argument);
  CHECK_THROWS_AS(near(1, -0.1), std::invalid_argument);
  CHECK_THROWS_AS(near(1, kNaN), std::invalid_argument);
  CHECK_THROWS_AS(near(kInfinity, 0.1), std::invalid_argument);
  CHECK_THROWS_AS(within(kInfinity, 1), std::invalid_argument);
  CHECK_THROWS_AS(within(1, kInfinity), std::invalid_argument);
  CHECK_THROWS_AS(within(1, -1), std::invalid_argument);
  CHECK_THROWS_AS(within(1, kNaN), std::invalid_argument);
}

TEST_CASE("a failed comparison shows the value and the tolerance") {
  CHECK(doctest::toString(within(46.3, 0.1)) == "46.3 +- 0.1");
  CHECK(doctest::toString(near(5, 0.02)) == "5 +- 0.1");
}

}  // namespace palpate::near_test
