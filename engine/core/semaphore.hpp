#pragma once

#include <memory>

namespace palpate {

/// Posted by one thread, taken by another; neither operation allocates or takes a lock, so that a real-time thread can
/// use both.
class Semaphore {
 public:
  Semaphore();
  ~Semaphore();
  Semaphore(const Semaphore&) = delete;
  Semaphore& operator=(const Semaphore&) = delete;

  void post() noexcept;
  void take();
  /// False: timeout.
  bool takeWithin(double budget_us);

 private:
  struct System;
  std::unique_ptr<System> system_;
};

}  // namespace palpate
