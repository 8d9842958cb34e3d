// Statistics of a link, from pings. Independent of DDS.
#pragma once

#include <cstdint>
#include <deque>

#include "haptics/shared_follower.hpp"

namespace palpate::sharing {

/// All times are of one clock, with any zero. Not thread-safe.
class LinkStatistics {
 public:
  /// A ping is sent; returns its number, from 1.
  std::uint32_t sent(double now_s);
  /// Its echo was received. False, and ignored, if none of the last pings has that number or it was received before.
  bool answered(std::uint32_t number, double now_s);
  LinkCounts counts(double now_s) const;

 private:
  struct Ping {
    double sent_s = 0;
    double trip_s = -1;  // negative: not answered
  };

  std::deque<Ping> last_;
  std::uint32_t numbers_ = 0;  // pings sent
  std::uint64_t answered_ = 0;
  std::uint64_t lostBefore_ = 0;  // lost pings that are no longer among the last ones
};

}  // namespace palpate::sharing
