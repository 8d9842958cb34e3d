#include <cerrno>
#include <cstddef>
#include <ctime>
#include <new>

#include "haptics/session_clock.hpp"

namespace palpate {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

class MachineClock final : public SessionClock {
 public:
  std::int64_t now_ns() const noexcept override {
    timespec now{};
    ::clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * kSecond_ns + now.tv_nsec;
  }
  void waitUntil_ns(std::int64_t time_ns) noexcept override {
    const timespec until{.tv_sec = time_ns / kSecond_ns, .tv_nsec = time_ns % kSecond_ns};
    while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
    }
  }
};

}  // namespace

SessionClock& machineClock() noexcept {
  // It is never destroyed: the thread of a driver that nobody stopped still asks it while the process exits.
  alignas(MachineClock) static std::byte place[sizeof(MachineClock)];
  static auto& theMachines = *new (place) MachineClock;
  return theMachines;
}

}  // namespace palpate
