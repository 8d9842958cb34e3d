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
std::mutex installation;  // guards the handlers and the members below; never locked by a handler
std::array<const void*, CrashStop::kMaxDevices> owners;
int guarded = 0;

static_assert(std::atomic<HapticDevice*>::is_always_lock_free, "a lock in a handler might never be released");

}  // namespace

void stopGuardedDevices() noexcept {
  for (const auto& slot : devices)
    if (HapticDevice* device = slot.load()) device->emergencyStop();
}

CrashStop::CrashStop(HapticDevice& device, const void* owner) {
  const std::scoped_lock lock(installation);
  while (slot_ < kMaxDevices && devices[slot_].load()) ++slot_;
  if (slot_ == kMaxDevices) throw Error("{} devices have a force already, which is the maximum", kMaxDevices);
  owners[slot_] = owner;
  devices[slot_].store(&device);
  ++guarded;
  putCrashHandlersInPlace();
}

void CrashStop::resume(const void* owner) {
  const std::scoped_lock lock(installation);
  for (std::size_t slot = 0; slot < devices.size(); ++slot)
    if (HapticDevice* const device = devices[slot].load(); device && owners[slot] == owner) device->resume();
}

CrashStop::~CrashStop() {
  const std::scoped_lock lock(installation);
  if (--guarded == 0) putCrashHandlersBack();
  devices[slot_].store(nullptr);
}

}  // namespace palpate
