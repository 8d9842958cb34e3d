// A simulation against the clock: on a thread of its own, for which no tick waits longer than it may.
#pragma once

#include <atomic>
#include <optional>
#include <thread>

#include "engine/core/latest_value.hpp"
#include "engine/core/semaphore.hpp"
#include "engine/touch/matter_steps.hpp"

namespace palpate {

class MatterThread {
 public:
  /// `steps` outlives it.
  explicit MatterThread(MatterSteps& steps);
  ~MatterThread();
  MatterThread(const MatterThread&) = delete;
  MatterThread& operator=(const MatterThread&) = delete;

  /// The newest answer, which is that to this question where it comes within `budget_us` (0: as long as it takes);
  /// nothing before the first one. Allocates nothing and takes no lock. For one thread.
  std::optional<MatterAnswer> ask(const MatterQuestion& question, double budget_us) noexcept;
  /// Waits for the answer to the last question, if there was one.
  void finish();

 private:
  void serve();

  MatterSteps& steps_;
  LatestValue<MatterQuestion> asked_;
  LatestValue<MatterAnswer> answered_;
  std::optional<MatterAnswer> last_;
  std::optional<double> askedAt_s_;  // of the last question
  bool spins_;                       // within a budget: a thread that sleeps is now and then woken a whole tick late
  Semaphore wake_, done_;
  std::atomic<bool> stop_ = false;
  std::jthread thread_;  // goes first
};

}  // namespace palpate
