// Reports of a thread that sends forces, passed to a thread that has the time to say them.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <functional>
#include <thread>
#include <utility>

#include "engine/core/semaphore.hpp"
#include "engine/core/start_thread.hpp"

namespace palpate {

/// post() neither allocates nor waits, whatever the receiver does: a terminal that is stopped blocks what is written
/// to it. One thread posts.
template <class Code>
class ReportQueue {
 public:
  /// `report` is called on a thread of the queue, in order, also for what was posted before the end; what it throws is
  /// ignored.
  explicit ReportQueue(std::function<void(Code)> report) : report_(std::move(report)) {
    reporter_ = startThread([this](const std::stop_token& stop) { work(stop); });
  }
  ~ReportQueue() {
    reporter_.request_stop();
    posted_.post();
  }
  ReportQueue(const ReportQueue&) = delete;
  ReportQueue& operator=(const ReportQueue&) = delete;

  /// Dropped while kLength earlier ones are pending.
  void post(Code code) noexcept {
    const std::size_t end = end_.load(std::memory_order_relaxed);
    if (end - begin_.load(std::memory_order_acquire) == kLength) return;
    codes_[end % kLength] = code;
    end_.store(end + 1, std::memory_order_release);
    posted_.post();
  }

 private:
  static constexpr std::size_t kLength = 64;

  void work(const std::stop_token& stop) {
    while (true) {
      const std::size_t begin = begin_.load(std::memory_order_relaxed);
      if (begin == end_.load(std::memory_order_acquire)) {
        if (stop.stop_requested()) return;
        posted_.take();
        continue;
      }
      const Code code = codes_[begin % kLength];
      begin_.store(begin + 1, std::memory_order_release);
      try {
        report_(code);
      } catch (...) {  // NOLINT(bugprone-empty-catch): a listener may not end the device's thread
      }
    }
  }

  std::function<void(Code)> report_;
  std::array<Code, kLength> codes_{};
  std::atomic<std::size_t> begin_ = 0, end_ = 0;
  Semaphore posted_;
  std::jthread reporter_;  // destroyed first
};

}  // namespace palpate
