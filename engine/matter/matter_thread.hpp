// A simulation against the clock, on a thread of its own; no tick waits for it longer than its budget.
#pragma once

#include <atomic>
#include <optional>
#include <thread>

#include "engine/core/latest_value.hpp"
#include "engine/core/semaphore.hpp"
#include "engine/matter/matter_steps.hpp"

namespace palpate {

class MatterThread {
 public:
  /// `steps` must outlive it.
  explicit MatterThread(MatterSteps& steps);
  ~MatterThread();
  MatterThread(const MatterThread&) = delete;
  MatterThread& operator=(const MatterThread&) = delete;

  /// Returns the newest answer: the one to this question if it arrives within `budget_us` (0: no limit); nullopt before
  /// the first answer. Allocates nothing and takes no lock. For one thread.
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
  bool spins_;                       // spins within a budget, as a sleeping thread occasionally wakes a whole tick late
  Semaphore wake_, done_;
  std::atomic<bool> stop_ = false;
  std::jthread thread_;  // destroyed first
};

}  // namespace palpate
