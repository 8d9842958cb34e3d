#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

namespace palpate {

/// Bytes that come when they come: a pipe, or standard input. One thread reads, and another one may end its waiting.
class InterruptibleInput {
 public:
  /// `descriptor` stays the caller's, and outlives it. Throws Error where the system has no room for it.
  explicit InterruptibleInput(int descriptor);
  ~InterruptibleInput();
  InterruptibleInput(const InterruptibleInput&) = delete;
  InterruptibleInput& operator=(const InterruptibleInput&) = delete;

  /// Waits, and reads as many bytes as are there, at least one; 0 at the end, and once stop() was called. Throws Error
  /// that says why where the system cannot.
  std::size_t read(std::span<std::byte> bytes);
  /// From any thread.
  void stop() noexcept;
  bool isStopped() const noexcept { return stopped_; }

 private:
  int descriptor_;
  std::intptr_t wake_ = -1;  // what ends a wait, where the system needs something
  std::atomic<bool> stopped_ = false;
};

}  // namespace palpate
