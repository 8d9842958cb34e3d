#include "haptics/realtime_priority.hpp"

#include <pthread.h>
#include <sched.h>
#include <sys/prctl.h>

namespace palpate {

RealtimePriority::RealtimePriority() noexcept {
  before_.slack_ns = ::prctl(PR_GET_TIMERSLACK);
  ::prctl(PR_SET_TIMERSLACK, 1UL);  // 50 us by default, half a tick of 10 kHz; real-time threads have none
  sched_param parameters{};
  if (::pthread_getschedparam(::pthread_self(), &before_.policy, &parameters) != 0) return;
  before_.priority = parameters.sched_priority;
  // Above ordinary real-time work, below the kernel's own threads, whose interrupts the GPU's answer needs.
  const int lowest = ::sched_get_priority_min(SCHED_FIFO), highest = ::sched_get_priority_max(SCHED_FIFO);
  parameters.sched_priority = lowest + (highest - lowest) * 2 / 5;
  granted_ = ::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &parameters) == 0;
}

RealtimePriority::~RealtimePriority() {
  sched_param parameters{};
  parameters.sched_priority = before_.priority;
  if (granted_) ::pthread_setschedparam(::pthread_self(), before_.policy, &parameters);
  if (before_.slack_ns > 0) ::prctl(PR_SET_TIMERSLACK, static_cast<unsigned long>(before_.slack_ns));
}

const char* RealtimePriority::command() noexcept {
  return "echo \"$USER - rtprio 60\" | sudo tee /etc/security/limits.d/90-palpate.conf   # then log in again";
}

std::int64_t RealtimePriority::wakesWithin_ns() noexcept { return 50'000; }

}  // namespace palpate
