// Ticks of several hands on their way to a display: complete, in step, and dropped as a whole if they are not read.
#include "haptics/session/tick_feed.hpp"

#include <doctest/doctest.h>

namespace palpate::tick_feed_test {

namespace {

void tick(TickFeed& feed, std::uint64_t number, std::size_t hands) {
  const auto row = [&](std::size_t hand) {
    return TraceRow{.time_s = static_cast<double>(number), .neighbours = static_cast<std::uint32_t>(hand)};
  };
  for (std::size_t hand = 1; hand < hands; ++hand) feed.tickedToo(hand, row(hand));
  feed.ticked(row(0), {});
}

}  // namespace

TEST_CASE("the rows of all hands at a tick are delivered together, in order") {
  for (const std::size_t hands : {1u, 2u, 3u, 8u}) {
    CAPTURE(hands);
    TickFeed feed(hands);
    std::vector<TraceRow> rows;
    for (std::uint64_t i = 0; i < 100; ++i) {
      tick(feed, i, hands);
      if (i % 7 == 0) feed.take(rows);
    }
    feed.take(rows);
    REQUIRE(rows.size() == 100 * hands);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      CHECK(rows[i].time_s == static_cast<double>(i / hands));
      CHECK(rows[i].neighbours == i % hands);
    }
  }
}

TEST_CASE("a full feed drops ticks with all their hands, and later ticks are complete") {
  constexpr std::uint64_t kMore = (1 << 15) + 1000;
  TickFeed feed(2);
  for (std::uint64_t i = 0; i < kMore; ++i) tick(feed, i, 2);
  // The second hand finds no room, and the reader takes all rows before the first hand's row is written.
  std::vector<TraceRow> rows;
  feed.tickedToo(1, {.time_s = -1, .neighbours = 1});
  feed.take(rows);
  feed.ticked({.time_s = -1}, {});
  tick(feed, kMore, 2);
  feed.take(rows);
  REQUIRE(rows.size() == 2 * ((1 << 15) + 1));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    CHECK(rows[i].neighbours == i % 2);
    CHECK(rows[i].time_s >= 0);
    if (i % 2 == 1) CHECK(rows[i].time_s == rows[i - 1].time_s);
  }
  CHECK(rows.back().time_s == static_cast<double>(kMore));
}

TEST_CASE("the share of ticks on time is 100 % only if none was late") {
  const auto onTime_percent = [](std::size_t ticks, std::size_t late) {
    std::vector<TraceRow> rows(ticks);
    for (std::size_t i = 0; i < late; ++i) rows[i].missed = 1;
    RecentTicks history;
    history.add(rows);
    return history.onTime_percent();
  };
  CHECK(onTime_percent(0, 0) == 100);
  CHECK(onTime_percent(100, 0) == 100);
  CHECK(onTime_percent(100, 2) == 98);
  CHECK(onTime_percent(10'000, 1) == 99.9);
  CHECK(onTime_percent(3, 1) == 66.6);
  CHECK(onTime_percent(10, 10) == 0);
}

}  // namespace palpate::tick_feed_test
