#include "haptics/crash_stop.hpp"

#include <array>
#include <atomic>
#include <mutex>

#include "engine/core/error.hpp"
#include "haptics/crash_handlers.hpp"

namespace palpate {
namespace {

// A handler has no arguments of its own, so what it needs is global.
std::array<std::atomic<HapticDevice*>, CrashStop::kMaxDevices> devices;
std::mutex installation;  // guards installing and restoring handlers; never locked by a handler
int guarded = 0;

static_assert(std::atomic<HapticDevice*>::is_always_lock_free, "a lock in a handler might never be released");

}  // namespace

void stopGuardedDevices() noexcept {
  for (const auto& slot : devices)
    if (HapticDevice* device = slot.load()) device->emergencyStop();
}

CrashStop::CrashStop(HapticDevice& device) {
  const std::scoped_lock lock(installation);
  while (slot_ < kMaxDevices && devices[slot_].load()) ++slot_;
  if (slot_ == kMaxDevices) throw Error("{} devices have a force already, which is the maximum", kMaxDevices);
  devices[slot_].store(&device);
  if (guarded++ == 0) putCrashHandlersInPlace();
}

CrashStop::~CrashStop() {
  const std::scoped_lock lock(installation);
  if (--guarded == 0) putCrashHandlersBack();
  devices[slot_].store(nullptr);
}

}  // namespace palpate
