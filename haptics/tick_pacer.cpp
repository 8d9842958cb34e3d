#include "haptics/tick_pacer.hpp"

#include <pthread.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <ctime>

namespace palpate {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

std::int64_t now_ns() noexcept {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * kSecond_ns + now.tv_nsec;
}

}  // namespace

RealtimePriority::RealtimePriority() noexcept {
  if (::pthread_getschedparam(::pthread_self(), &oldPolicy_, &oldParameters_) != 0) return;
  // Above ordinary real-time work, below the kernel's own threads, whose interrupts the GPU's answer needs.
  const int lowest = ::sched_get_priority_min(SCHED_FIFO), highest = ::sched_get_priority_max(SCHED_FIFO);
  sched_param wanted{};
  wanted.sched_priority = lowest + (highest - lowest) * 2 / 5;
  granted_ = ::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &wanted) == 0;
}

RealtimePriority::~RealtimePriority() {
  if (granted_) ::pthread_setschedparam(::pthread_self(), oldPolicy_, &oldParameters_);
}

TickPacer::TickPacer(double rate_Hz) noexcept : period_ns_(1e9 / rate_Hz), start_ns_(now_ns()) {}

std::int64_t TickPacer::due_ns(std::uint64_t index) const noexcept {
  return start_ns_ + std::llround(static_cast<double>(index) * period_ns_);
}

std::uint64_t TickPacer::waitFor(std::uint64_t index) const noexcept {
  const std::int64_t due = due_ns(index);
  const timespec until{.tv_sec = due / kSecond_ns, .tv_nsec = due % kSecond_ns};
  while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
  const auto late_ns = static_cast<double>(now_ns() - due);
  return late_ns > period_ns_ ? index + static_cast<std::uint64_t>(late_ns / period_ns_) : index;
}

double TickPacer::remaining_us(std::uint64_t index) const noexcept {
  return static_cast<double>(due_ns(index) - now_ns()) * 1e-3;
}

}  // namespace palpate
