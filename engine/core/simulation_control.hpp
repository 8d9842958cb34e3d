#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// A number of what moves by itself that can be changed while it does.
struct SimulationParameter {
  std::string name;   ///< as files have it
  std::string label;  ///< for who reads
  std::string unit;   ///< empty: 1
  double value = 0;
  double low = 0, high = 0;  ///< that it is taken from and to

  bool operator==(const SimulationParameter&) const = default;
};

/// Energy that a hand has put into a simulation since it began, less what it got back, J, against the forces that it
/// got, with their gain and after all limits: a port is passive where that is never below 0.
struct PortEnergy {
  double now_J = 0, least_J = 0;
};

/// Ticks in which the points about a hand did not say where the surface of a soft body is under it, as in a dent that
/// is deeper than wide.
struct SurfaceHolds {
  std::uint64_t keptTicks = 0;     ///< it was held by the place of the body that it pressed on
  std::uint64_t gaveWayTicks = 0;  ///< of those the ones in which the body bore it no more, and gave way evenly
};

/// How a person governs what moves by itself. For any thread.
class SimulationControl {
 public:
  virtual ~SimulationControl() = default;

  /// Stands still, and no hand feels it, or goes on.
  virtual void hold(bool held) noexcept = 0;
  virtual bool isHeld() const noexcept = 0;
  /// Everything goes back to where it began, with the next tick.
  virtual void reset() noexcept = 0;
  /// As they were set last.
  virtual std::vector<SimulationParameter> parameters() const = 0;
  /// From the next step on. Throws Error where there is no such parameter, or its value is none that can be simulated;
  /// nothing is changed then.
  virtual void set(std::string_view name, double value) = 0;
  /// Time by which it has stayed behind the clock, and which it leaves out, s.
  virtual double leftOut_s() const noexcept = 0;
  /// How often it has gone on: each time hands feel it anew.
  virtual std::uint64_t advances() const noexcept = 0;
  /// Of all hands; of soft bodies alone.
  virtual SurfaceHolds surfaceHolds() const noexcept { return {}; }
  /// Of each hand.
  virtual std::vector<PortEnergy> portEnergies() const = 0;
  /// Why it goes on no more, in words that follow "the simulation"; empty while it does.
  virtual std::string failure() const = 0;
};

}  // namespace palpate
