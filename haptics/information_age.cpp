#include "haptics/information_age.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace palpate {
namespace {

constexpr double kFull_s = 1, kAgeFade_s = 1;
constexpr double kRoundTrips = 2.5;
constexpr double kLongestTrip_s = 2, kUnknownTrip_s = 1;
/// From the offer of a change until its force has risen.
constexpr double kChanging_s = 0.1;

double seconds(InformationAge::Clock::rep ticks) {
  return std::chrono::duration<double>(InformationAge::Clock::duration(ticks)).count();
}

double tripOf(double roundTrip_s) {
  return std::isfinite(roundTrip_s) ? std::clamp(roundTrip_s, 0.0, kLongestTrip_s) : kUnknownTrip_s;
}

}  // namespace

AgeLimits ageLimits(double roundTrip_s) noexcept {
  const double full_s = kFull_s + kRoundTrips * tripOf(roundTrip_s);
  return {.full_s = full_s, .gone_s = full_s + kAgeFade_s};
}

double shareAt(double age_s, const AgeLimits& limits) noexcept {
  if (!(age_s < limits.gone_s)) return 0;
  if (age_s <= limits.full_s) return 1;
  return (limits.gone_s - age_s) / (limits.gone_s - limits.full_s);
}

void InformationAge::heard(Clock::time_point now) noexcept {
  const auto ago = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(tripOf(roundTrip_s_) / 2));
  // A round trip longer than before does not make known information older.
  said_ = std::max(said_.load(), (now - ago).time_since_epoch().count());
}

double InformationAge::age_s(Clock::time_point now) const noexcept {
  return std::max(0.0, seconds(now.time_since_epoch().count() - said_));
}

bool InformationAge::isChanging(Clock::time_point now) const noexcept {
  const Clock::rep changed = changed_;
  return changed != 0 && seconds(now.time_since_epoch().count() - changed) < kChanging_s;
}

}  // namespace palpate
