// How old what is known of a cloud that others change, too, may be, and how much of a force it still bears.
#pragma once

#include <atomic>
#include <cstdint>

#include "engine/core/clock.hpp"

namespace palpate {

/// Ages between which a force fades, s.
struct AgeLimits {
  double full_s = 0;  ///< the whole force passes up to here
  double gone_s = 0;  ///< and none from here on
};

/// One second and two and a half round trips are full: who serves a cloud is heard twice a second, half a round trip
/// after it has spoken; what is lost on the way comes a round trip later, and, where that is lost, too, another one.
/// The force is gone a second after that. A round trip counts two seconds at most, and one where it is no number.
AgeLimits ageLimits(double roundTrip_s) noexcept;

/// The share of a force that knowledge of that age bears: whole, then evenly less, then nothing. Nothing where the age
/// is no number.
double shareAt(double age_s, const AgeLimits& limits) noexcept;

/// The age of what is known: the time since what was heard last was said. One thread hears, and any other one asks, at
/// each tick: a thread that hangs grows old like a link that does.
class InformationAge {
 public:
  using Clock = Stopwatch::Clock;

  /// As of now all is known, and a round trip takes a second until somebody knows better.
  explicit InformationAge(Clock::time_point now = Clock::now()) noexcept : said_(now.time_since_epoch().count()) {}

  // For the thread that hears.
  /// Of who serves the cloud: what is heard was said half a round trip ago.
  void heard(Clock::time_point now = Clock::now()) noexcept;
  void setRoundTrip(double roundTrip_s) noexcept { roundTrip_s_ = roundTrip_s; }
  /// Others are changing the surface that the hand touches.
  void changed(Clock::time_point now = Clock::now()) noexcept { changed_ = now.time_since_epoch().count(); }
  /// For good: no force any more.
  void fail() noexcept { isTrue_ = false; }

  // For any thread.
  AgeLimits limits() const noexcept { return ageLimits(roundTrip_s_); }
  double age_s(Clock::time_point now = Clock::now()) const noexcept;
  double share(Clock::time_point now = Clock::now()) const noexcept { return shareAt(age_s(now), limits()); }
  /// False after fail().
  bool isTrue() const noexcept { return isTrue_; }
  /// Whether others have changed what the hand touches within the last moment.
  bool isChanging(Clock::time_point now = Clock::now()) const noexcept;

 private:
  std::atomic<Clock::rep> said_, changed_{0};
  std::atomic<double> roundTrip_s_{1};
  std::atomic<bool> isTrue_{true};
};

}  // namespace palpate
