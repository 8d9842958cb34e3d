// What pings say of a link, without DDS.
#pragma once

#include <cstdint>
#include <deque>

#include "haptics/shared_follower.hpp"

namespace palpate::sharing {

/// Times are of one clock, from any zero. One thread uses it at a time.
class LinkStatistics {
 public:
  /// A ping goes out: its number, from 1 on.
  std::uint32_t sent(double now_s);
  /// Its echo has come. False where none of the last pings had that number, or it came before: that counts for nothing.
  bool answered(std::uint32_t number, double now_s);
  LinkCounts counts(double now_s) const;

 private:
  struct Ping {
    double sent_s = 0;
    double trip_s = -1;  // negative: not answered
  };

  std::deque<Ping> last_;
  std::uint32_t numbers_ = 0;  // of pings, as sent
  std::uint64_t answered_ = 0;
  std::uint64_t lostBefore_ = 0;  // of those that are not among the last any more
};

}  // namespace palpate::sharing
