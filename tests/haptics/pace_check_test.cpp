// The waiting of the servo loop, without work.
#include "haptics/pace_check.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "engine/core/clock.hpp"
#include "engine/core/error.hpp"
#include "haptics/tick_pacer.hpp"

namespace palpate::pace_check_test {

TEST_CASE("every tick is run or counted as missed, within the requested time") {
  const Stopwatch watch;
  const PaceCheck check = checkPace(500, 0.2);
  CHECK(watch.elapsed_s() >= 0.198);  // the last tick is due then
  CHECK(check.ticks + check.missed == 100);
  CHECK(check.late_us.count() == check.ticks);
  CHECK_THROWS_AS(checkPace(0, 1), UsageError);
  CHECK_THROWS_AS(checkPace(1000, -1), UsageError);
  CHECK_THROWS_AS(checkPace(1000, 1e9), UsageError);
}

TEST_CASE("a session has at least one tick, and no more than fit into memory") {
  CHECK(plannedTicks(1000, 0) == 1);
  CHECK(plannedTicks(10'000, 60) == 600'000);
  CHECK_THROWS_AS(plannedTicks(1000, std::nan("")), UsageError);
  CHECK_THROWS_AS(plannedTicks(200'000, 1), UsageError);
}

}  // namespace palpate::pace_check_test
