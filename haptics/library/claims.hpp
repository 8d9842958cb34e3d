// Exclusion of calls on a session: at most one thread that touches and one that looks.
#pragma once

#include <atomic>
#include <chrono>
#include <thread>

#include "engine/core/clock.hpp"
#include "engine/core/system_file.hpp"
#include "haptics/library/callbacks.hpp"
#include "haptics/library/failures.hpp"
#include "haptics/servo_mailbox.hpp"

namespace palpate::library {

/// Throws StateError.
inline void refuseInCallback() {
  if (isInCallback) throw StateError("a log or contact function cannot call a session, matter or a server");
}

/// The process in which an object was opened: after a fork, its threads, locks and GPU remain in the parent.
class HomeProcess {
 public:
  bool isThis() const noexcept { return number_ == processNumber(); }
  /// Throws StateError.
  void require() const {
    if (!isThis())
      throw StateError("this was opened before fork() and works in the parent process alone; open another one here");
  }

 private:
  int number_ = processNumber();
};

enum class Claim : unsigned { touch = 1, look = 2, all = 3 };

class Claims {
 public:
  const HomeProcess& home() const { return home_; }

  /// Held for the duration of a call. Throws ThreadError if another thread holds a conflicting claim, StateError in a
  /// log or contact function and in another process.
  class Held {
   public:
    Held(Claims& claims, Claim claim) : claims_(claims), bits_(static_cast<unsigned>(claim)) { claims_.take(bits_); }
    /// While `waits` is true, waits for the calls of other threads. Throws CommandTimeout, too.
    Held(Claims& claims, Claim claim, const std::atomic<bool>& waits)
        : claims_(claims), bits_(static_cast<unsigned>(claim)) {
      claims_.takeInTurn(bits_, waits);
    }
    ~Held() { claims_.taken_.fetch_and(~bits_, std::memory_order_release); }
    Held(const Held&) = delete;
    Held& operator=(const Held&) = delete;

   private:
    Claims& claims_;
    unsigned bits_;
  };

 private:
  void take(unsigned bits) {
    refuseInCallback();
    home_.require();
    if (!isTaken(bits)) throw ThreadError("another thread is in a call on this session that conflicts with this one");
  }
  void takeInTurn(unsigned bits, const std::atomic<bool>& waits) {
    refuseInCallback();
    home_.require();
    for (const Stopwatch since; !isTaken(bits);) {
      if (!waits) return take(bits);
      if (since.elapsed_s() > ServoMailbox::kTimeout_s)
        throw CommandTimeout("another thread has been in a call on this live session for {:.3g} s",
                             ServoMailbox::kTimeout_s);
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
  }
  // False if another thread holds one of them.
  bool isTaken(unsigned bits) {
    unsigned before = taken_.load(std::memory_order_relaxed);
    do {
      if (before & bits) return false;
    } while (!taken_.compare_exchange_weak(before, before | bits, std::memory_order_acquire));
    return true;
  }

  HomeProcess home_;
  std::atomic<unsigned> taken_ = 0;
};

}  // namespace palpate::library
