#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

namespace palpate {

/// Input from a pipe or standard input. One thread reads; another thread may interrupt it.
class InterruptibleInput {
 public:
  /// `descriptor` remains the caller's, and must outlive the object. Throws Error if system resources are exhausted.
  explicit InterruptibleInput(int descriptor);
  ~InterruptibleInput();
  InterruptibleInput(const InterruptibleInput&) = delete;
  InterruptibleInput& operator=(const InterruptibleInput&) = delete;

  /// Blocks until data is available, and reads at least one byte; 0 at the end, and after stop(). Throws Error with the
  /// reason if the system fails.
  std::size_t read(std::span<std::byte> bytes);
  /// From any thread.
  void stop() noexcept;
  bool isStopped() const noexcept { return stopped_; }

 private:
  int descriptor_;
  std::intptr_t wake_ = -1;  // handle that interrupts a wait, if the system needs one
  std::atomic<bool> stopped_ = false;
};

}  // namespace palpate
