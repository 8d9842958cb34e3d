#include "haptics/sharing/link_statistics.hpp"

#include <vector>

#include "engine/core/statistics.hpp"

namespace palpate::sharing {

namespace {

constexpr std::size_t kKeptTrips = 128;
constexpr double kLate_s = 2;  // then a ping counts as lost, unless its echo is received later

}  // namespace

std::uint32_t LinkStatistics::sent(double now_s) {
  last_.push_back({.sent_s = now_s});
  if (last_.size() > kKeptTrips) {
    lostBefore_ += last_.front().trip_s < 0;
    last_.pop_front();
  }
  return ++numbers_;
}

bool LinkStatistics::answered(std::uint32_t number, double now_s) {
  const std::uint32_t before = numbers_ - static_cast<std::uint32_t>(last_.size());
  if (number <= before || number > numbers_) return false;
  Ping& ping = last_[number - before - 1];
  if (ping.trip_s >= 0 || !(now_s >= ping.sent_s)) return false;
  ping.trip_s = now_s - ping.sent_s;
  ++answered_;
  return true;
}

LinkCounts LinkStatistics::counts(double now_s) const {
  std::vector<double> trips_ms;
  std::uint64_t lost = 0;
  for (const Ping& ping : last_) {
    if (ping.trip_s >= 0) trips_ms.push_back(ping.trip_s * 1e3);
    lost += ping.trip_s < 0 && now_s - ping.sent_s > kLate_s;
  }
  LinkCounts counts{.pings = numbers_, .answered = answered_, .lost = lostBefore_ + lost};
  const std::uint64_t judged = lost + trips_ms.size();
  if (judged > 0) counts.lost_percent = 100 * static_cast<double>(lost) / static_cast<double>(judged);
  if (!trips_ms.empty()) counts.roundTrip_ms = summarize(trips_ms).p50;
  return counts;
}

}  // namespace palpate::sharing
