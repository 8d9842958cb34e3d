// A call that takes long, and the program's functions that watch it.
#pragma once

#include <palpate/palpate.h>

#include <atomic>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>

#include "engine/core/job_stop.hpp"

namespace palpate::library {

/// Runs what takes long on a thread of its own while the thread of the call asks the program whether to stop and tells
/// it how far it is. One call at a time.
class Watch {
 public:
  explicit Watch(const pp_watch& watch) : watch_(watch) {}
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

  /// On this thread where nobody watches. Where JobStop wants it, `act` ends in between (JobStopScope::cutting()), and
  /// throws Stopped. Throws what it throws.
  void run(const std::function<void()>& act);
  /// Where all of it may be cut.
  void runCut(const std::function<void()>& act) {
    run([&] {
      const JobStopScope cuts(JobStopScope::cutting());
      act();
    });
  }
  bool isTold() const { return watch_.progress != nullptr; }
  /// How far the call is. From any thread.
  void progressed(std::string_view what, double share);

 private:
  void forget();
  void tell();

  const pp_watch watch_;
  std::atomic<bool> stop_ = false;
  std::mutex lock_;  // of what follows
  std::string what_;
  double share_ = 0;
  bool isNew_ = false;  // not told yet
};

}  // namespace palpate::library
