// Whether what a session serves has begun anew, as water does that a hand has driven too fast.
#pragma once

#include <optional>

#include "engine/core/clock.hpp"
#include "haptics/far_cloud.hpp"
#include "haptics/sharing/messages.hpp"

namespace palpate::sharing {

/// One thread uses it at a time.
class RestartWatch {
 public:
  /// The participant outlives it.
  RestartWatch(const Participant& participant, const Id& session);
  RestartWatch(const RestartWatch&) = delete;
  RestartWatch& operator=(const RestartWatch&) = delete;
  /// How often it has since the last call, and why it last did; nothing where it has not. What was before the first
  /// time that this was heard is not meant, and more than twice a second nobody is told.
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
