#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// A parameter of a simulation that can be changed while it runs.
struct SimulationParameter {
  std::string name;   ///< the name in files
  std::string label;  ///< for display
  std::string unit;   ///< empty: dimensionless
  double value = 0;
  double low = 0, high = 0;  ///< accepted range

  bool operator==(const SimulationParameter&) const = default;
};

/// Energy that a hand has put into a simulation since its start, less the energy it got back, J, computed with the
/// forces that the hand received, with their gain and after all limits: a port is passive if this is never below 0.
struct PortEnergy {
  double now_J = 0, min_J = 0;
};

/// Ticks in which the points about a hand did not determine the surface of a soft body under it, as in a dent that is
/// deeper than wide.
struct SurfaceHolds {
  std::uint64_t keptTicks = 0;     ///< the surface was held by the position on the body that the hand pressed on
  std::uint64_t gaveWayTicks = 0;  ///< of these, ticks in which the body could no longer bear it and yielded evenly
};

/// User control of a simulation. For any thread.
class SimulationControl {
 public:
  virtual ~SimulationControl() = default;

  /// Pauses the simulation, so that no hand feels it, or resumes it.
  virtual void pause(bool paused) noexcept = 0;
  virtual bool isPaused() const noexcept = 0;
  /// Resets everything to the initial state, with the next tick.
  virtual void reset() noexcept = 0;
  /// With the values last set.
  virtual std::vector<SimulationParameter> parameters() const = 0;
  /// Takes effect with the next step. Throws Error if there is no such parameter or its value cannot be simulated;
  /// nothing is changed then.
  virtual void set(std::string_view name, double value) = 0;
  /// Time by which the simulation fell behind the clock and which it dropped, s.
  virtual double dropped_s() const noexcept = 0;
  /// Number of advances of the simulation; hands feel a new state after each.
  virtual std::uint64_t advances() const noexcept = 0;
  /// Sum over all hands; soft bodies only.
  virtual SurfaceHolds surfaceHolds() const noexcept { return {}; }
  /// One for each hand.
  virtual std::vector<PortEnergy> portEnergies() const = 0;
  /// Why the simulation stopped, in words that follow "the simulation"; empty while it runs.
  virtual std::string failure() const = 0;
};

}  // namespace palpate
