// Detects restarts of a session's simulation, as of water that a hand has driven too fast.
#pragma once

#include <optional>

#include "engine/core/clock.hpp"
#include "haptics/session/far_cloud.hpp"
#include "haptics/sharing/messages.hpp"

namespace palpate::sharing {

/// Not thread-safe.
class RestartWatch {
 public:
  /// The participant must outlive it.
  RestartWatch(const Participant& participant, const Id& session);
  RestartWatch(const RestartWatch&) = delete;
  RestartWatch& operator=(const RestartWatch&) = delete;
  /// Number of restarts since the last call, and the reason of the last one; nothing if there was none. Restarts before
  /// the first facts received do not count. Reports at most twice a second.
  std::optional<Restarts> fresh();

 private:
  Id session_;
  Topic<Facts> topic_;
  Reader<Facts> reader_;
  Restarts heard_;
  std::optional<std::uint32_t> told_;
  std::optional<Stopwatch> lastTold_;
};

}  // namespace palpate::sharing
