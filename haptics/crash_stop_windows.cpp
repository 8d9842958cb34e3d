#include <windows.h>

#include <array>
#include <atomic>
#include <csignal>
#include <mutex>

#include "engine/core/check.hpp"
#include "haptics/crash_stop.hpp"

namespace palpate {
namespace {

// A handler has no arguments of its own choosing, so what it needs has to stand where it can find it.
std::array<std::atomic<HapticDevice*>, CrashStop::kMostDevices> devices;
LPTOP_LEVEL_EXCEPTION_FILTER formerFilter = nullptr;  // written before a handler is in place
void (*formerAbort)(int) = SIG_DFL;
std::mutex places;  // for putting handlers in place and back; never held by one
int guarded = 0;

static_assert(std::atomic<HapticDevice*>::is_always_lock_free, "a lock in a handler may never be given back");

void stopAll() {
  for (const auto& slot : devices)
    if (HapticDevice* device = slot.load()) device->emergencyStop();
}

LONG WINAPI stopAtFault(EXCEPTION_POINTERS* fault) {
  stopAll();
  return formerFilter ? formerFilter(fault) : EXCEPTION_CONTINUE_SEARCH;
}

void stopAtAbort(int signal) {
  stopAll();
  std::signal(SIGABRT, formerAbort);
  if (formerAbort != SIG_DFL && formerAbort != SIG_IGN) formerAbort(signal);
}

// Ctrl+C, Ctrl+Break, a console that is closed, a user who logs off: on a thread that the system starts for it. Whoever
// was in place before is asked next.
BOOL WINAPI stopAtEnd(DWORD) {
  stopAll();
  return FALSE;
}

void putInPlace() {
  formerFilter = ::SetUnhandledExceptionFilter(stopAtFault);
  formerAbort = std::signal(SIGABRT, stopAtAbort);
  ::SetConsoleCtrlHandler(stopAtEnd, TRUE);
}

void putBack() {
  ::SetConsoleCtrlHandler(stopAtEnd, FALSE);
  std::signal(SIGABRT, formerAbort);
  ::SetUnhandledExceptionFilter(formerFilter);
}

}  // namespace

CrashStop::CrashStop(HapticDevice& device) {
  const std::scoped_lock lock(places);
  while (slot_ < kMostDevices && devices[slot_].load()) ++slot_;
  PALPATE_CHECK_LT(slot_, kMostDevices);
  devices[slot_].store(&device);
  if (guarded++ == 0) putInPlace();
}

CrashStop::~CrashStop() {
  const std::scoped_lock lock(places);
  if (--guarded == 0) putBack();
  devices[slot_].store(nullptr);
}

}  // namespace palpate
