#include "haptics/sharing/link_statistics.hpp"

#include <doctest/doctest.h>

#include "tests/near.hpp"

namespace palpate::sharing::link_statistics_test {

TEST_CASE("a link has no statistics before a ping has returned or is late") {
  LinkStatistics link;
  CHECK(link.sent(10) == 1);
  LinkCounts counts = link.counts(11);
  CHECK(counts.pings == 1);
  CHECK_FALSE(counts.roundTrip_ms);
  CHECK_FALSE(counts.lost_percent);
  counts = link.counts(12.5);
  CHECK(counts.lost == 1);
  CHECK(*counts.lost_percent == 100);
  // A late answer is not lost.
  link.answered(1, 12.6);
  counts = link.counts(13);
  CHECK(counts.lost == 0);
  CHECK(*counts.lost_percent == 0);
  CHECK(*counts.roundTrip_ms == near(2600, 1e-6));
}

TEST_CASE("the round trip is the median of recent pings, and a loss of every tenth ping is reported") {
  LinkStatistics link;
  for (int i = 0; i < 1000; ++i) {
    const double now_s = 0.2 * i, trip_s = i < 800 ? 0.5 : i % 2 == 0 ? 0.1 : 0.12;
    const std::uint32_t number = link.sent(now_s);
    if (i % 10 != 3) link.answered(number, now_s + trip_s);
  }
  const LinkCounts counts = link.counts(300);
  CHECK(counts.pings == 1000);
  CHECK(counts.answered == 900);
  CHECK(counts.lost == 100);
  CHECK(*counts.lost_percent == near(10, 0.1));
  CHECK(*counts.roundTrip_ms > 99);
  CHECK(*counts.roundTrip_ms < 121);
}

TEST_CASE("duplicate echoes, echoes of pings never sent, and echoes older than their ping are ignored") {
  LinkStatistics link;
  const std::uint32_t number = link.sent(1);
  CHECK_FALSE(link.answered(number, 0.5));
  CHECK_FALSE(link.answered(0, 1.1));
  CHECK_FALSE(link.answered(2, 1.1));
  CHECK_FALSE(link.answered(0xffffffff, 1.1));
  CHECK(link.counts(1.2).answered == 0);
  CHECK(link.answered(number, 1.1));
  CHECK_FALSE(link.answered(number, 1.4));
  CHECK(link.counts(2).answered == 1);
  CHECK(*link.counts(2).roundTrip_ms == near(100, 1e-6));
  for (int i = 0; i < 200; ++i) link.sent(2 + 0.01 * i);
  link.answered(number + 1, 9);  // sent too long ago
  CHECK(link.counts(9).answered == 1);
  CHECK(link.counts(9).lost == 200);
}

}  // namespace palpate::sharing::link_statistics_test
