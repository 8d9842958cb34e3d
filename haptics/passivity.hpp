// Whether the rendered surface returns more energy than it received, a damper that takes the surplus back, and a limit
// of it where others change the surface.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <utility>

#include "engine/core/vec.hpp"
#include "haptics/devices/haptic_device.hpp"

namespace palpate {

enum class PassivityMode {
  off,
  observe,  ///< count the energy, change no force
  on        ///< count it and brake
};
/// The modes by the names in the user interface.
inline constexpr std::array<std::pair<std::string_view, PassivityMode>, 3> kPassivityModes{
    {{"on", PassivityMode::on}, {"observe", PassivityMode::observe}, {"off", PassivityMode::off}}};

/// Time-domain passivity (Hannaford, Ryu 2002): an observer and a controller at the port between the hand and the
/// surface. Energies are those that the surface has taken in, in mJ (N mm): pressing it adds, being pushed out by it
/// subtracts, so a surface of springs and dampers only, felt without delay, never falls below zero. Energy below zero
/// was made by sampling or delay. If a damper could take it back only after the hand is out and free, as for a hand
/// that withdraws fast, it is not given in the first place. On a moving surface the displacement of the hand relative
/// to it counts; the surface's own motion has a limit of its own (ForceOptions::maxSurfacePower_W).
///
/// Where others have changed the surface under a hand, its spring may be stretched farther than this side has pressed
/// it, more than a damper takes back. Until that contact ends, the hand gets at most kLent_mJ more than it has put in,
/// and kBeginning_mJ to sink in again from zero: its force is at most that of a spring that stores the remaining
/// energy.
class Passivity {
 public:
  static constexpr double kLent_mJ = 0.5, kBeginning_mJ = 0.2;
  /// Given beyond that while a force falls to its limit.
  static constexpr double kFall_mJ = 0.1;

  /// `stiffness_N_per_mm`: of the spring between hand and surface; a force that would give too much is limited by it.
  Passivity(PassivityMode mode, const DeviceLimits& limits, double stiffness_N_per_mm) noexcept;

  /// Others are changing the surface. A deficit of this contact from before is cancelled.
  void changed() noexcept {
    if (!isLending_) energy_mJ_ = std::max(energy_mJ_, 0.0);
    isLending_ = true;
  }

  /// Accounts for the time since the last tick, in which the hand moved to `position_mm` and the surface moved with
  /// `surface_mm_per_s` (millimetres of the device). Returns the wanted force with the controller's damping: it brakes
  /// the motion, but never turns a push into a pull.
  DVec3 damped(const DVec3& wanted_N, const DVec3& position_mm, double dt_s,
               const DVec3& surface_mm_per_s = DVec3(0)) noexcept;

  /// The force that the device was given in this tick. Once there is no force, the next contact counts from zero:
  /// energy that one contact took in must not pay for the next.
  void acted(const DVec3& force_N) noexcept;

  /// Forgets the hand's position, so that a jump does not count as work.
  void lift() noexcept;

  /// The spring between hand and surface has another stiffness from now on.
  void setStiffness(double stiffness_N_per_mm) noexcept;

  double energy_mJ() const noexcept { return energy_mJ_; }
  double leastEnergy_mJ() const noexcept { return leastEnergy_mJ_; }
  template <class Visit>
  void visitState(Visit& visit) noexcept {
    for (DVec3& force_N : forces_N_) visit(force_N);
    visit(position_mm_, lastWay_mm_, known_, energy_mJ_, isWanted_, isLending_, held_N_, sunk_mm_, last_N_, gift_mJ_);
  }

 private:
  static constexpr std::size_t kMaxDelay = 3;

  DVec3 braked(const DVec3& wanted_N, const DVec3& way_mm, double dt_s) const noexcept;
  DVec3 withinMeans(const DVec3& force_N, const DVec3& way_mm, const DVec3& change_mm, double dt_s) const noexcept;
  double leftAlong_mJ(const DVec3& way_mm) const noexcept;
  void end() noexcept;
  double fallingTo(double most_N, double size_N, double inwards_mm, double dt_s) noexcept;
  DVec3 lent(const DVec3& force_N, const DVec3& way_mm, double dt_s) noexcept;

  PassivityMode mode_;
  double stiffness_N_per_mm_;
  double mostDamping_N_s_per_mm_;
  std::size_t delay_;
  std::array<DVec3, kMaxDelay + 1> forces_N_{};  ///< written at the last tick, the one before it, ...
  DVec3 position_mm_{0};
  DVec3 lastWay_mm_{0};  ///< in the previous tick
  bool known_ = false;   ///< position_mm_ is that of the last tick
  double energy_mJ_ = 0, leastEnergy_mJ_ = 0;
  bool isWanted_ = false;         ///< there is a force to pass in this tick
  bool isLending_ = false;        ///< others have changed the surface of this contact
  std::optional<double> held_N_;  ///< the limited force of the last tick, if one was limited
  double last_N_ = 0;             ///< size of the force of the last tick
  double gift_mJ_ = 0;            ///< given in this contact beyond the limit of the energy, while the force fell to it
  double sunk_mm_ = 0;            ///< how far the hand has moved in since it last moved out
};

}  // namespace palpate
