// Age of the information about a cloud that others change, too, and how much of a force it permits.
#pragma once

#include <atomic>

#include "engine/core/clock.hpp"

namespace palpate {

/// Ages between which a force fades, s.
struct AgeLimits {
  double full_s = 0;  ///< the whole force passes up to here
  double gone_s = 0;  ///< and none from here on
};

/// The whole force up to 1 s plus 2.5 round trips: a server is heard twice a second, half a round trip after it sends;
/// a lost message is received a round trip later, or two if it is lost again. No force one second after that. A round
/// trip counts at most two seconds, and one second if it is not a number.
AgeLimits ageLimits(double roundTrip_s) noexcept;

/// Share of a force at that age: 1, then linearly less, then 0. Also 0 if the age is not a number.
double shareAt(double age_s, const AgeLimits& limits) noexcept;

/// Age of the information: the time since the last received message was sent. One thread receives; any other thread
/// queries it at each tick, so that a hung thread ages it as a broken link does.
class InformationAge {
 public:
  using Clock = Stopwatch::Clock;

  /// Starts with current information; a round trip counts one second until one is measured.
  explicit InformationAge(Clock::time_point now = Clock::now()) noexcept : said_(now.time_since_epoch().count()) {}

  // For the thread that receives.
  /// A message of the server was received: it was sent half a round trip ago.
  void heard(Clock::time_point now = Clock::now()) noexcept;
  void setRoundTrip(double roundTrip_s) noexcept { roundTrip_s_ = roundTrip_s; }
  /// Others are changing the surface that the hand touches.
  void changed(Clock::time_point now = Clock::now()) noexcept { changed_ = now.time_since_epoch().count(); }
  /// From now on the information counts as false, permanently: no force any more.
  void fail() noexcept { isTrue_ = false; }

  // For any thread.
  double roundTrip_s() const noexcept { return roundTrip_s_; }
  AgeLimits limits() const noexcept { return ageLimits(roundTrip_s_); }
  double age_s(Clock::time_point now = Clock::now()) const noexcept;
  double share(Clock::time_point now = Clock::now()) const noexcept { return shareAt(age_s(now), limits()); }
  /// False after fail().
  bool isTrue() const noexcept { return isTrue_; }
  /// Whether others have just changed what the hand touches.
  bool isChanging(Clock::time_point now = Clock::now()) const noexcept;

 private:
  std::atomic<Clock::rep> said_, changed_{0};
  std::atomic<double> roundTrip_s_{1};
  std::atomic<bool> isTrue_{true};
};

}  // namespace palpate
