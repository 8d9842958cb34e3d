// Which ticks are done, how late, and a query's time budget, on the test's own clock, independent of the machine's
// load.
#include "haptics/tick_pacer.hpp"

#include <doctest/doctest.h>

#include <limits>

#include "engine/core/clock.hpp"
#include "engine/core/error.hpp"
#include "haptics/pace_check.hpp"
#include "haptics/tick_histogram.hpp"
#include "tests/near.hpp"

namespace palpate::tick_pacer_test {

namespace {

/// Wakes a sleeper with a given delay.
class LateClock final : public SessionClock {
 public:
  std::int64_t now_ns() const noexcept override { return now_ns_; }
  void waitUntil_ns(std::int64_t time_ns) noexcept override {
    if (time_ns > now_ns_) now_ns_ = time_ns + late_ns;
  }
  void pass(double time_us) { now_ns_ += static_cast<std::int64_t>(1e3 * time_us); }

  std::int64_t late_ns = 0;

 private:
  std::int64_t now_ns_ = 5'000'000'000;
};

}  // namespace

TEST_CASE("each tick is due whole periods after the first, however long earlier ticks took") {
  for (const double rate_Hz : {1000.0, 10'000.0, 3000.0}) {
    CAPTURE(rate_Hz);
    LateClock clock;
    const std::int64_t start_ns = clock.now_ns();
    const TickPacer pacer(rate_Hz, false, &clock);
    for (std::uint64_t index = 0; index < 1000; ++index) {
      REQUIRE(pacer.waitFor(index) == index);  // no tick is missed
      REQUIRE(static_cast<double>(clock.now_ns() - start_ns) == within(1e9 * static_cast<double>(index) / rate_Hz, 1));
      clock.pass((0.1 + 0.8 * static_cast<double>(index % 2)) * 1e6 / rate_Hz);  // a short tick, then a long one
    }
  }
}

TEST_CASE("a tick that starts less than a period late is run, and lateness does not accumulate") {
  LateClock clock;
  const TickPacer pacer(1000, false, &clock);
  clock.late_ns = 900'000;
  for (std::uint64_t index = 1; index < 100; ++index) {
    REQUIRE(pacer.waitFor(index) == index);
    REQUIRE(-pacer.remaining_us(index) == within(900, 1e-3));
    clock.pass(50);
  }
}

TEST_CASE("ticks skipped by a pause of several periods are missed, and the next one is on time") {
  LateClock clock;
  const TickPacer pacer(1000, false, &clock);
  CHECK(pacer.waitFor(0) == 0);
  clock.pass(4700);
  CHECK(pacer.waitFor(1) == 4);  // 1, 2 and 3 are lost; 4 is 0.7 ms late
  CHECK(-pacer.remaining_us(4) == within(700, 1e-3));
  CHECK(pacer.passed() == 3);
  CHECK(pacer.waitFor(5) == 5);
  CHECK(pacer.remaining_us(5) == 0);
}

TEST_CASE("a query has a tick less the reserve for the force, which is at most a fifth of a tick") {
  LateClock clock;
  const TickPacer slow(1000, false, &clock), fast(10'000, false, &clock);
  CHECK(slow.budget_us(0, 200) == within(800, 1e-3));
  CHECK(slow.budget_us(0, 50) == within(950, 1e-3));
  CHECK(fast.budget_us(0, 200) == within(80, 1e-3));
  clock.pass(30);  // woken late
  CHECK(slow.budget_us(0, 200) == within(770, 1e-3));
  CHECK(fast.budget_us(0, 200) == within(50, 1e-3));
  clock.pass(45);
  CHECK(fast.budget_us(0, 200) == 20);  // never 0, which would mean no limit
  clock.pass(5000);
  CHECK(slow.budget_us(0, 200) == 20);
}

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

TEST_CASE("every time falls into the bin whose ends enclose it") {
  for (const double time_us : {1.0, 1.1, 2.0, 37.0, 1000.0, 99'999.0, 500'000.0}) {
    TickHistogram histogram;
    histogram.add(time_us);
    std::size_t bin = 0;
    while (histogram[bin] == 0) ++bin;
    CHECK(TickHistogram::from_us(bin) <= time_us);
    CHECK(TickHistogram::from_us(bin + 1) > time_us);
    CHECK(histogram.count() == 1);
    CHECK(histogram.max_us() == time_us);
  }
}

TEST_CASE("times out of range and those that are not numbers are counted at the ends") {
  TickHistogram histogram;
  for (const double time_us : {0.0, -5.0, 0.3}) histogram.add(time_us);
  CHECK(histogram[0] == 3);
  for (const double time_us : {1e12, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()})
    histogram.add(time_us);
  CHECK(histogram[TickHistogram::kBins - 1] == 3);
  CHECK(histogram.count() == 6);
}

TEST_CASE("quantiles are exact to a bin and never beyond the maximum") {
  TickHistogram histogram;
  CHECK(histogram.quantile_us(0.5) == 0);
  for (int i = 1; i <= 1000; ++i) histogram.add(i);
  for (const double q : {0.1, 0.5, 0.99}) {
    CHECK(histogram.quantile_us(q) >= 1000 * q);
    CHECK(histogram.quantile_us(q) <= 1000 * q * 1.19);
  }
  CHECK(histogram.quantile_us(1) == 1000);
}

}  // namespace palpate::tick_pacer_test
