#include "engine/core/semaphore.hpp"

#include <semaphore.h>

#include <algorithm>
#include <cerrno>
#include <ctime>

#include "engine/core/check.hpp"

// ThreadSanitizer of GCC 12 follows sem_wait(), but does not know sem_clockwait().
#ifdef __SANITIZE_THREAD__
extern "C" void __tsan_acquire(void* address);
#define PALPATE_TAKEN(semaphore) __tsan_acquire(semaphore)
#else
#define PALPATE_TAKEN(semaphore) static_cast<void>(semaphore)
#endif

namespace palpate {

struct Semaphore::System {
  sem_t semaphore;
};

Semaphore::Semaphore() : system_(std::make_unique<System>()) { sem_init(&system_->semaphore, 0, 0); }

Semaphore::~Semaphore() { sem_destroy(&system_->semaphore); }

void Semaphore::post() noexcept { sem_post(&system_->semaphore); }

void Semaphore::take() {
  while (sem_wait(&system_->semaphore) != 0) PALPATE_CHECK_EQ(errno, EINTR);
}

bool Semaphore::takeWithin(double budget_us) {
  constexpr long kSecond_ns = 1'000'000'000;
  constexpr double kLongest_us = 1e12;
  timespec until{};
  clock_gettime(CLOCK_MONOTONIC, &until);
  const auto budget_ns = static_cast<long long>(std::min(budget_us, kLongest_us) * 1e3);
  until.tv_sec += budget_ns / kSecond_ns;
  until.tv_nsec += static_cast<long>(budget_ns % kSecond_ns);
  if (until.tv_nsec >= kSecond_ns) {
    ++until.tv_sec;
    until.tv_nsec -= kSecond_ns;
  }
  while (sem_clockwait(&system_->semaphore, CLOCK_MONOTONIC, &until) != 0) {
    if (errno == ETIMEDOUT) return false;
    PALPATE_CHECK_EQ(errno, EINTR);
  }
  PALPATE_TAKEN(&system_->semaphore);
  return true;
}

}  // namespace palpate
