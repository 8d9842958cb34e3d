// Statistics of a link, from pings. Independent of DDS.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "haptics/server_file.hpp"
#include "haptics/shared_follower.hpp"
#include "haptics/sharing/messages.hpp"

namespace palpate::sharing {

/// A client's request that its server write its file, in the pings, until an echo answers it. Independent of DDS.
/// A server counts the writes of its file. Requested is one that begins after the request: each echo says which that
/// is. Not thread-safe.
class WriteRequest {
 public:
  /// `lastPing`: number of the last ping that was sent.
  void begin(std::uint32_t lastPing) { *this = WriteRequest(lastPing); }
  /// Ping::write of the next ping.
  std::uint64_t write() const { return answer_ ? 0 : write_; }
  /// Echoes come in any order.
  void answered(const Ping& echo) {
    if (!after_ || answer_ || echo.number <= *after_) return;
    if (!echo.writes) {
      answer_ = ServerSave{.words = "it was started without --save"};
    } else if (write_ > 0 && echo.ended >= write_) {
      answer_ =
          ServerSave{.written = !echo.failed, .points = echo.failed ? 0 : echo.points, .words = printable(echo.words)};
    } else if (write_ == 0 || echo.begun + 1 < write_) {  // fewer: another server has taken over
      write_ = echo.begun + 1;
    }
  }
  const std::optional<ServerSave>& answer() const { return answer_; }

  WriteRequest() = default;

 private:
  explicit WriteRequest(std::uint32_t lastPing) : after_(lastPing) {}

  std::optional<std::uint32_t> after_;  // echoes of later pings count
  std::uint64_t write_ = 0;             // 0: not known yet
  std::optional<ServerSave> answer_;
};

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
