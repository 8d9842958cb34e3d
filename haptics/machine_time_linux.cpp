#include "haptics/machine_time.hpp"

#include <cerrno>
#include <ctime>

namespace palpate {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

}  // namespace

// CLOCK_BOOTTIME counts the time in which the machine sleeps, too: a hand may have moved meanwhile, so that it is a
// pause after which ForceGate waits for free space.
std::int64_t machineTime_ns() noexcept {
  timespec now{};
  ::clock_gettime(CLOCK_BOOTTIME, &now);
  return now.tv_sec * kSecond_ns + now.tv_nsec;
}

void waitUntilMachineTime_ns(std::int64_t time_ns) noexcept {
  const timespec until{.tv_sec = time_ns / kSecond_ns, .tv_nsec = time_ns % kSecond_ns};
  while (::clock_nanosleep(CLOCK_BOOTTIME, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
}

}  // namespace palpate
