// Whether the rendered surface gives more energy than it was given, a damper that takes the surplus back, and a limit
// to it where others change the surface.
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
/// The modes by the names that users know.
inline constexpr std::array<std::pair<std::string_view, PassivityMode>, 3> kPassivityModes{
    {{"on", PassivityMode::on}, {"observe", PassivityMode::observe}, {"off", PassivityMode::off}}};

/// Time-domain passivity (Hannaford, Ryu 2002): an observer and a controller at the port between the hand and the
/// surface. Energies are what the surface has taken in, in mJ (N mm): pressing it adds, being pushed out by it takes
/// away, so a surface with springs and dampers only, felt without delay, never falls below zero. What falls below was
/// made by sampling or delay. What a damper could take back only once the hand is out and free, where a fast hand draws
/// back, is not given to begin with. Where the surface moves, the way that counts is the hand's relative to it: what
/// its own motion does to the hand has a limit of its own (ForceOptions::maxSurfacePower_W).
///
/// Where others have changed the surface under a hand, its spring may be stretched farther than anybody on this side
/// has pressed it, more than a damper takes back: until that contact ends the hand gets no more than kLent_mJ that it
/// has not put in, and kBeginning_mJ to sink in again from nothing: its force is at most that of a spring which holds
/// what is left.
class Passivity {
 public:
  static constexpr double kLent_mJ = 0.5, kBeginning_mJ = 0.2;

  /// `stiffness_N_per_mm`: of the spring between hand and surface; what is left of a force that gives too much falls by
  /// it.
  Passivity(PassivityMode mode, const DeviceLimits& limits, double stiffness_N_per_mm) noexcept;

  /// Others are changing the surface. What this contact owes from before is not held against what comes now.
  void changed() noexcept {
    if (!isLending_) energy_mJ_ = std::max(energy_mJ_, 0.0);
    isLending_ = true;
  }

  /// Counts what happened since the last tick, in which the hand came to `position_mm` and the surface moved with
  /// `surface_mm_per_s` (millimetres of the device), and returns the wanted force with the controller's damping: it
  /// brakes the motion, but never turns a push into a pull.
  DVec3 damped(const DVec3& wanted_N, const DVec3& position_mm, double dt_s,
               const DVec3& surface_mm_per_s = DVec3(0)) noexcept;

  /// The force that the device was given at this tick. Once no force is left the next contact counts from zero: what
  /// one contact took in must not pay for the next.
  void acted(const DVec3& force_N) noexcept;

  /// Forgets where the hand was, so that a jump is not taken for work.
  void lift() noexcept;

  double energy_mJ() const noexcept { return energy_mJ_; }
  double leastEnergy_mJ() const noexcept { return leastEnergy_mJ_; }

 private:
  static constexpr std::size_t kMaxDelay = 3;

  DVec3 braked(const DVec3& wanted_N, const DVec3& way_mm, double dt_s) const noexcept;
  DVec3 withinMeans(const DVec3& force_N, const DVec3& way_mm, const DVec3& change_mm, double dt_s) const noexcept;
  double leftAlong_mJ(const DVec3& way_mm) const noexcept;
  void end() noexcept;
  DVec3 lent(const DVec3& force_N, const DVec3& way_mm, double dt_s) noexcept;

  PassivityMode mode_;
  double stiffness_N_per_mm_;
  double mostDamping_N_s_per_mm_;
  std::size_t delay_;
  std::array<DVec3, kMaxDelay + 1> forces_N_{};  ///< written at the last tick, the one before it, ...
  DVec3 position_mm_{0};
  DVec3 lastWay_mm_{0};  ///< in the tick before
  bool known_ = false;   ///< position_mm_ is that of the last tick
  double energy_mJ_ = 0, leastEnergy_mJ_ = 0;
  bool isWanted_ = false;         ///< there was a force to be passed at this tick
  bool isLending_ = false;        ///< others have changed the surface of this contact
  std::optional<double> held_N_;  ///< what of a force that would have given too much was passed at the last tick
  double sunk_mm_ = 0;            ///< how far the hand has come in since it was going out
};

}  // namespace palpate
