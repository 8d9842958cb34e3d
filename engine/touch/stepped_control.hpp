// What a simulation that follows the time of hands has in common, whoever steps it.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>

#include "engine/core/simulation_control.hpp"
#include "engine/core/touch_backend.hpp"
#include "engine/matter/matter_simulation.hpp"

namespace palpate {

/// How a simulation is held and begun anew, which parameters it has, how many steps it has to go, and why it goes on no
/// more. What is public is for any thread; the rest for the one that steps, which waits for nobody but while a
/// parameter is set.
class SteppedControl : public SimulationControl {
 public:
  void reset() noexcept override { reset_.store(true); }
  void hold(bool held) noexcept override { held_.store(held); }
  bool isHeld() const noexcept override { return held_.load(); }
  double leftOut_s() const noexcept override {
    return kMatterStep_s * static_cast<double>(leftOut_.load(std::memory_order_relaxed));
  }
  std::uint64_t advances() const noexcept override { return advances_.load(std::memory_order_relaxed); }
  std::vector<PortEnergy> portEnergies() const override;
  std::string failure() const override;
  std::vector<SimulationParameter> parameters() const override;
  void set(std::string_view name, double value) override;
  /// Whether steps beyond the most at a time are left out, as at first, or made up for.
  void setLeavesOut(bool leavesOut) noexcept { leavesOut_.store(leavesOut); }

 protected:
  /// `hands`: as many as put energy into `world`. `mostAtOnce`: steps at a time; those beyond it are left out. 0: any
  /// number.
  SteppedControl(const MatterSimulation& world, std::size_t hands, std::uint32_t mostAtOnce);

  bool isToBeReset() const { return reset_.load(); }
  /// Whether it is to begin anew; asked once.
  bool takeReset() { return reset_.exchange(false); }
  /// The number of the step that it has come to; nothing before the first one.
  const std::optional<std::int64_t>& last() const { return last_; }
  /// Where time goes back it begins anew.
  bool goesBack(std::int64_t step) const { return last_ && step < *last_; }
  /// It begins anew.
  void forget() noexcept;
  /// Steps to the one with that number, of which the first ones are `atFirst`.
  std::uint32_t stepsTo(std::int64_t step, std::uint32_t atFirst);
  void see(MatterState state) { state_.store(state); }
  /// What was set since the last call.
  void takeParameters(MatterSimulation& world);
  /// What a hand has put in since the beginning, after each step.
  void seeEnergy(std::size_t hand, double energy_J) noexcept;

 private:
  std::uint32_t mostAtOnce_;
  std::optional<std::int64_t> last_;
  std::atomic<bool> reset_ = false, held_ = false, changed_ = false, leavesOut_ = true;
  std::atomic<std::uint64_t> leftOut_ = 0;  // steps
  std::atomic<std::uint64_t> advances_ = 0;
  std::atomic<MatterState> state_ = MatterState::running;
  struct Meter {
    std::atomic<double> now_J = 0, least_J = 0;
  };
  std::array<Meter, kMaxHands> meters_;
  std::size_t hands_;
  std::uint64_t memory_bytes_;  // that the simulation may take
  mutable std::mutex mutex_;    // of what follows
  MatterScene scene_;           // with all parameters as they were set
};

}  // namespace palpate
