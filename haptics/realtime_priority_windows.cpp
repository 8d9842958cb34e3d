#include "haptics/realtime_priority.hpp"

#include <windows.h>

#include <avrt.h>
#include <timeapi.h>

namespace palpate {

// The multimedia scheduler raises a thread above what an ordinary program may request; if its service does not run, the
// highest ordinary priority remains. Meanwhile the system's timer has its finest resolution.
RealtimePriority::RealtimePriority() noexcept {
  ::timeBeginPeriod(1);
  DWORD index = 0;
  before_.task = ::AvSetMmThreadCharacteristicsW(L"Pro Audio", &index);
  if (before_.task) ::AvSetMmThreadPriority(before_.task, AVRT_PRIORITY_CRITICAL);
  before_.priority = ::GetThreadPriority(::GetCurrentThread());
  granted_ = ::SetThreadPriority(::GetCurrentThread(), THREAD_PRIORITY_TIME_CRITICAL) || before_.task;
}

RealtimePriority::~RealtimePriority() {
  if (before_.priority != THREAD_PRIORITY_ERROR_RETURN) ::SetThreadPriority(::GetCurrentThread(), before_.priority);
  if (before_.task) ::AvRevertMmThreadCharacteristics(before_.task);
  ::timeEndPeriod(1);
}

const char* RealtimePriority::command() noexcept { return ""; }

// Its timers have a resolution of half a millisecond at best.
std::int64_t RealtimePriority::wakesWithin_ns() noexcept { return 1'000'000; }

}  // namespace palpate
