#include "engine/core/semaphore.hpp"

#include <windows.h>

#include <algorithm>
#include <limits>

#include "engine/core/check.hpp"
#include "engine/core/clock.hpp"

namespace palpate {

struct Semaphore::System {
  HANDLE semaphore;
};

Semaphore::Semaphore()
    : system_(std::make_unique<System>(::CreateSemaphoreW(nullptr, 0, std::numeric_limits<LONG>::max(), nullptr))) {
  PALPATE_CHECK(system_->semaphore);
}

Semaphore::~Semaphore() { ::CloseHandle(system_->semaphore); }

void Semaphore::post() noexcept { ::ReleaseSemaphore(system_->semaphore, 1, nullptr); }

void Semaphore::take() { PALPATE_CHECK_EQ(::WaitForSingleObject(system_->semaphore, INFINITE), WAIT_OBJECT_0); }

// The system waits in whole milliseconds and may wake up one late: it waits for all but the last one, and the remainder
// is spent yielding the core repeatedly.
bool Semaphore::takeWithin(double budget_us) {
  constexpr double kLongest_us = 1e12, kMax_ms = 1e9;
  const double budget = std::min(budget_us, kLongest_us);
  const Stopwatch since;
  for (double left_us = budget; left_us > 0; left_us = budget - since.elapsed_us()) {
    const double asleep_ms = std::clamp(left_us * 1e-3 - 1, 0.0, kMax_ms);
    if (::WaitForSingleObject(system_->semaphore, static_cast<DWORD>(asleep_ms)) == WAIT_OBJECT_0) return true;
    if (asleep_ms < 1) ::SwitchToThread();
  }
  return ::WaitForSingleObject(system_->semaphore, 0) == WAIT_OBJECT_0;
}

}  // namespace palpate
