#include <windows.h>

#include "haptics/machine_time.hpp"

namespace palpate {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr std::int64_t kTimerUnit_ns = 100;
constexpr DWORD kHighResolution = 0x2;  // CREATE_WAITABLE_TIMER_HIGH_RESOLUTION, missing in headers of 2017

/// The finest timer of the system; each thread needs its own.
class Timer {
 public:
  Timer() noexcept : handle_(::CreateWaitableTimerExW(nullptr, nullptr, kHighResolution, TIMER_ALL_ACCESS)) {
    if (!handle_) handle_ = ::CreateWaitableTimerW(nullptr, TRUE, nullptr);  // before Windows 10 of 2018
  }
  ~Timer() {
    if (handle_) ::CloseHandle(handle_);
  }
  Timer(const Timer&) = delete;
  Timer& operator=(const Timer&) = delete;

  /// False on failure.
  bool waitFor(std::int64_t time_ns) const noexcept {
    LARGE_INTEGER due;
    due.QuadPart = -(time_ns / kTimerUnit_ns);  // negative: relative to now
    return handle_ && ::SetWaitableTimer(handle_, &due, 0, nullptr, nullptr, FALSE) &&
           ::WaitForSingleObject(handle_, INFINITE) == WAIT_OBJECT_0;
  }

 private:
  HANDLE handle_;
};

}  // namespace

std::int64_t machineTime_ns() noexcept {
  LARGE_INTEGER count, perSecond;
  ::QueryPerformanceCounter(&count);
  ::QueryPerformanceFrequency(&perSecond);
  const std::int64_t seconds = count.QuadPart / perSecond.QuadPart, rest = count.QuadPart % perSecond.QuadPart;
  return seconds * kSecond_ns + rest * kSecond_ns / perSecond.QuadPart;
}

void waitUntilMachineTime_ns(std::int64_t time_ns) noexcept {
  thread_local const Timer timer;
  for (std::int64_t left_ns = time_ns - machineTime_ns(); left_ns > 0; left_ns = time_ns - machineTime_ns())
    if (left_ns < kTimerUnit_ns || !timer.waitFor(left_ns)) ::SwitchToThread();
}

}  // namespace palpate
