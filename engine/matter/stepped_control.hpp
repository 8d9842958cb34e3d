// Common part of simulations that follow the time of the hands, whatever steps them.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>

#include "engine/core/simulation_control.hpp"
#include "engine/matter/matter_simulation.hpp"
#include "engine/touch/touch_backend.hpp"

namespace palpate {

/// Pause and restart of a simulation, its parameters, the number of steps due, and the reason of a failure. The public
/// part is for any thread; the rest for the stepping thread, which waits only while a parameter is being set.
class SteppedControl : public SimulationControl {
 public:
  void reset() noexcept override { reset_.store(true); }
  void pause(bool paused) noexcept override { paused_.store(paused); }
  bool isPaused() const noexcept override { return paused_.load(); }
  double dropped_s() const noexcept override {
    return kMatterStep_s * static_cast<double>(leftOut_.load(std::memory_order_relaxed));
  }
  std::uint64_t advances() const noexcept override { return advances_.load(std::memory_order_relaxed); }
  std::vector<PortEnergy> portEnergies() const override;
  std::string failure() const override;
  std::vector<SimulationParameter> parameters() const override;
  void set(std::string_view name, double value) override;
  /// Whether steps beyond the maximum at a time are dropped (the default) or caught up.
  void setLeavesOut(bool leavesOut) noexcept { leavesOut_.store(leavesOut); }

 protected:
  /// `hands`: number of hands that put energy into `world`. `mostAtOnce`: maximum number of steps at a time, further
  /// steps are dropped; 0: unlimited.
  SteppedControl(const MatterSimulation& world, std::size_t hands, std::uint32_t mostAtOnce);

  bool isToBeReset() const { return reset_.load(); }
  /// Whether a restart was requested; clears the request.
  bool takeReset() { return reset_.exchange(false); }
  /// Number of the last step; nullopt before the first one.
  const std::optional<std::int64_t>& last() const { return last_; }
  /// Whether time went back to this step, which requires a restart.
  bool goesBack(std::int64_t step) const { return last_ && step < *last_; }
  /// Resets the step number and the energies, for a restart.
  void forget() noexcept;
  /// Number of steps up to step `step`; `atFirst` for the first call.
  std::uint32_t stepsTo(std::int64_t step, std::uint32_t atFirst);
  void see(MatterState state) { state_.store(state); }
  /// Applies the parameters set since the last call.
  void takeParameters(MatterSimulation& world);
  /// Records a hand's energy input since the start, after each step.
  void seeEnergy(std::size_t hand, double energy_J) noexcept;

 private:
  std::uint32_t mostAtOnce_;
  std::optional<std::int64_t> last_;
  std::atomic<bool> reset_ = false, paused_ = false, changed_ = false, leavesOut_ = true;
  std::atomic<std::uint64_t> leftOut_ = 0;  // number of steps
  std::atomic<std::uint64_t> advances_ = 0;
  std::atomic<MatterState> state_ = MatterState::running;
  struct Meter {
    std::atomic<double> now_J = 0, min_J = 0;
  };
  std::array<Meter, kMaxHands> meters_;
  std::size_t hands_;
  std::uint64_t memory_bytes_;  // limit for the simulation
  mutable std::mutex mutex_;    // guards scene_
  MatterScene scene_;           // with all parameters as set
};

}  // namespace palpate
