#pragma once

#include <string>

namespace palpate {

/// How a person governs what moves by itself. For any thread.
class SimulationControl {
 public:
  virtual ~SimulationControl() = default;

  /// Stands still, and no hand feels it, or goes on.
  virtual void hold(bool held) noexcept = 0;
  virtual bool isHeld() const noexcept = 0;
  /// Everything goes back to where it began, with the next tick.
  virtual void reset() noexcept = 0;
  /// Time by which it has stayed behind the clock, and which it leaves out, s.
  virtual double leftOut_s() const noexcept = 0;
  /// Why it goes on no more, in words that follow "the simulation"; empty while it does.
  virtual std::string failure() const = 0;
};

}  // namespace palpate
