#include "engine/core/background_task.hpp"

#include <algorithm>
#include <cerrno>
#include <ctime>
#include <utility>

#include "engine/core/check.hpp"

namespace palpate {

void BackgroundTask::Signal::take() {
  while (sem_wait(&semaphore_) != 0) PALPATE_CHECK_EQ(errno, EINTR);
}

bool BackgroundTask::Signal::takeWithin(double budget_us) {
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
  while (sem_clockwait(&semaphore_, CLOCK_MONOTONIC, &until) != 0) {
    if (errno == ETIMEDOUT) return false;
    PALPATE_CHECK_EQ(errno, EINTR);
  }
  return true;
}

BackgroundTask::BackgroundTask(std::function<void()> work) : work_(std::move(work)), thread_([this] { serve(); }) {}

BackgroundTask::~BackgroundTask() {
  if (running_) end_.take();
  stop_ = true;
  begin_.post();
}

void BackgroundTask::start() {
  PALPATE_CHECK(!running_);
  running_ = true;
  begin_.post();
}

bool BackgroundTask::finishedWithin(double budget_us) {
  if (!running_) return true;
  if (budget_us > 0) {
    if (!end_.takeWithin(budget_us)) return false;
  } else {
    end_.take();
  }
  running_ = false;
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  return true;
}

void BackgroundTask::serve() {
  while (true) {
    begin_.take();
    if (stop_) return;
    try {
      work_();
    } catch (...) {
      failure_ = std::current_exception();
    }
    end_.post();
  }
}

}  // namespace palpate
