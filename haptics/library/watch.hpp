// Calls that take long, and the program's functions that watch them.
#pragma once

#include <palpate/palpate.h>

#include <atomic>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>

#include "engine/core/job_stop.hpp"

namespace palpate::library {

/// Runs a long call on a thread of its own, while the calling thread queries the program whether to stop it and reports
/// progress. One call at a time.
class Watch {
 public:
  explicit Watch(const pp_watch& watch) : watch_(watch) {}
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

  /// Runs `act`, on this thread if the program has no watch functions. If a stop is requested, `act` ends early and
  /// throws Stopped, between its steps or anywhere within JobStopScope::cutting(). Rethrows its exceptions.
  void run(const std::function<void()>& act);
  /// The same for a call that may be cut anywhere.
  void runCut(const std::function<void()>& act) {
    run([&] {
      const JobStopScope cuts(JobStopScope::cutting());
      act();
    });
  }
  bool isTold() const { return watch_.progress != nullptr; }
  /// Sets the progress of the call. May be called from any thread.
  void progressed(std::string_view what, double share);

 private:
  void forget();
  void tell();

  const pp_watch watch_;
  std::atomic<bool> stop_ = false;
  std::mutex lock_;  // guards the members below
  std::string what_;
  double share_ = 0;
  bool isNew_ = false;  // not reported yet
};

}  // namespace palpate::library
