// How a person governs a simulation that another thread steps.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <mutex>

#include "engine/core/simulation_control.hpp"
#include "engine/core/touch_backend.hpp"
#include "engine/matter/matter_simulation.hpp"

namespace palpate {

/// What is asked for is taken by the thread that steps, before it does; it waits for nobody but while a parameter is set.
class SteppingControl : public SimulationControl {
 public:
  void reset() noexcept override { reset_.store(true); }
  void hold(bool held) noexcept override { held_.store(held); }
  bool isHeld() const noexcept override { return held_.load(); }
  double leftOut_s() const noexcept override {
    return kMatterStep_s * static_cast<double>(leftOut_.load(std::memory_order_relaxed));
  }
  std::vector<PortEnergy> portEnergies() const override;
  std::string failure() const override;
  std::vector<SimulationParameter> parameters() const override;
  void set(std::string_view name, double value) override;

 protected:
  /// `world`: as many `hands` are in it.
  SteppingControl(const MatterSimulation& world, std::size_t hands);

  // For the thread that steps.
  bool wantsReset() const noexcept { return reset_.load(); }
  bool takeReset() noexcept { return reset_.exchange(false); }
  /// Of so many steps that are due, those that are run: the rest is left out. `mostAtOnce` 0: any number.
  std::uint32_t runOf(std::int64_t due, std::uint32_t mostAtOnce) noexcept;
  void takeParameters(MatterSimulation& world);
  void tell(MatterState state) noexcept { state_.store(state); }
  /// What a hand has put in since the beginning, after each step.
  void tellEnergy(std::size_t hand, double energy_J) noexcept;
  /// Everything begins anew.
  void forgetEnergies() noexcept;

 private:
  std::atomic<bool> reset_ = false, held_ = false, changed_ = false;
  std::atomic<std::uint64_t> leftOut_ = 0;  // steps
  std::atomic<MatterState> state_ = MatterState::running;
  struct Meter {
    std::atomic<double> now_J = 0, least_J = 0;
  };
  std::array<Meter, kMostHands> meters_;
  std::size_t hands_;
  std::uint64_t memory_bytes_;  // that the simulation may take
  mutable std::mutex mutex_;    // of what follows
  MatterScene scene_;           // with all parameters as they were set
};

}  // namespace palpate
