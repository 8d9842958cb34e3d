#include "haptics/devices/replay_device.hpp"

#include <algorithm>
#include <utility>

#include "engine/core/check.hpp"

namespace palpate {

ReplayDevice::ReplayDevice(std::vector<LoggedTick> ticks, const DeviceLimits& limits)
    : ticks_(std::move(ticks)), limits_(limits) {
  PALPATE_CHECK(!ticks_.empty());
  PALPATE_CHECK(std::ranges::is_sorted(ticks_, {}, &LoggedTick::time_s));
}

DeviceState ReplayDevice::read(double time_s) noexcept {
  const auto after = std::ranges::upper_bound(ticks_, time_s, {}, &LoggedTick::time_s);
  const LoggedTick& tick = after == ticks_.begin() ? ticks_.front() : *(after - 1);
  const bool isNew = std::exchange(last_, &tick) != &tick;
  forcesOn_.store(!tick.has(LoggedTick::kForcesOff), std::memory_order_relaxed);
  return {.position = tick.device,
          .turn = tick.turn,
          .buttons = tick.buttons(),
          .putDown = isNew && tick.has(LoggedTick::kPutDown),
          .rendersForce = !tick.has(LoggedTick::kForceless),
          .ok = true};
}

}  // namespace palpate
