// What a simulation that follows the time of hands has in common, whoever steps it.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>

#include "engine/core/simulation_control.hpp"
#include "engine/matter/matter_simulation.hpp"

namespace palpate {

/// How a simulation is held and begun anew, how many steps it has to go, and why it goes on no more. What is public
/// is for any thread; the rest for the one that steps.
class SteppedControl : public SimulationControl {
 public:
  void reset() noexcept override { reset_.store(true); }
  void hold(bool held) noexcept override { held_.store(held); }
  bool isHeld() const noexcept override { return held_.load(); }
  double leftOut_s() const noexcept override {
    return kMatterStep_s * static_cast<double>(leftOut_.load(std::memory_order_relaxed));
  }
  std::string failure() const override;

 protected:
  /// `mostAtOnce`: steps at a time; those beyond it are left out. 0: any number.
  explicit SteppedControl(std::uint32_t mostAtOnce) : mostAtOnce_(mostAtOnce) {}

  bool isToBeReset() const { return reset_.load(); }
  /// Whether it is to begin anew; asked once.
  bool takeReset() { return reset_.exchange(false); }
  /// The number of the step that it has come to; nothing before the first one.
  const std::optional<std::int64_t>& last() const { return last_; }
  /// Where time goes back it begins anew.
  bool goesBack(std::int64_t step) const { return last_ && step < *last_; }
  void forget() { last_.reset(); }
  /// Steps to the one with that number, of which the first ones are `atFirst`.
  std::uint32_t stepsTo(std::int64_t step, std::uint32_t atFirst);
  void see(MatterState state) { state_.store(state); }

 private:
  std::uint32_t mostAtOnce_;
  std::optional<std::int64_t> last_;
  std::atomic<bool> reset_ = false, held_ = false;
  std::atomic<std::uint64_t> leftOut_ = 0;  // steps
  std::atomic<MatterState> state_ = MatterState::running;
};

}  // namespace palpate
