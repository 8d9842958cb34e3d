// From the answer of the surface to the force on one hand.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "engine/core/contact_query.hpp"
#include "haptics/devices/haptic_device.hpp"
#include "haptics/force_gate.hpp"
#include "haptics/force_law.hpp"
#include "haptics/information_age.hpp"
#include "haptics/passivity.hpp"

namespace palpate {

/// Age of the data from which a contact was computed, s: 0 if it is fresh; negative: there are none.
double dataAge_s(const Contact& contact, double now_s) noexcept;

/// Conditions of a tick that the answer does not contain.
struct TickConditions {
  bool forcesOn = true;     ///< the user wants forces
  double known = 1;         ///< TickSigns::known
  bool isChanging = false;  ///< others change the surface here: its motion is then their work
};

/// What the device of a hand adds to its pose.
struct DeviceSigns {
  DVec3 position{0};         ///< DeviceState::position
  bool rendersForce = true;  ///< DeviceState::rendersForce
  bool isOff = false;        ///< no force: the clutch is drawn, or a signal has stopped the device
  bool jumped = false;       ///< TickSigns::jumped
};

struct HandForceOptions {
  DeviceLimits limits;
  PassivityMode passivity = PassivityMode::off;
  double unitsPerDevice = 1;   ///< WorkspaceMap::scale, with the gain 1
  double rate_Hz = 1000;       ///< nominal, of the ticks
  std::size_t toolPoints = 0;  ///< of its tool; 0 for the HIP alone
  /// The answers and the pace of the ticks close the gate, too; otherwise they are the task of the program that asks.
  bool guardsTicks = true;
};

/// All stages between an answer and a force: the force law, the passivity controller and the gate.
class HandForce {
 public:
  /// The force is limited to the device's peak.
  HandForce(ForceLaw law, const HandForceOptions& options);

  /// Starts a session.
  void begin();
  /// Forgets the contact: the pose is unknown.
  void forget() noexcept { law_.reset(); }
  /// The hand was lifted, and is put down elsewhere.
  void lift() noexcept;
  /// Computes the force of an answer, which is zero at any fault. `points`: of a tool.
  void feel(const Contact& answer, std::span<const PointContact> points, const Pose& pose, double dt_s,
            const TickConditions& conditions, const DeviceSigns& device = {}) noexcept;
  /// The force that the device was given.
  void acted(const DVec3& force_N) noexcept { passivity_.acted(force_N); }
  /// Replaces the options of its force law, within the limits of its device. Between ticks.
  void setOptions(const ForceOptions& options) noexcept;

  // Of the last tick.
  /// "Nothing touched, not valid" where the answer was a fault or not finite.
  const Contact& contact() const noexcept { return contact_; }
  const DVec3& force_N() const noexcept { return force_N_; }
  /// Of a tool or a ball in matter, reduced in the same proportion as the force.
  const DVec3& torque_mNm() const noexcept { return torque_mNm_; }
  /// From HIP to proxy; 0 without contact.
  double penetration_mm() const noexcept { return penetration_mm_; }
  /// In contact the gate passes less than the whole force: forces are off, or were gone and return.
  bool isWithheld() const noexcept { return contact_.touching && gate_.share() < 1; }

  bool isHot() const noexcept { return gate_.isHot(); }

  const ForceLaw& law() const noexcept { return law_; }
  const GateCounts& withheld() const noexcept { return gate_.counts(); }
  const Passivity& passivity() const noexcept { return passivity_; }
  template <class Visit>
  void visitState(Visit& visit) noexcept {
    law_.visitState(visit);
    passivity_.visitState(visit);
    gate_.visitState(visit);
  }
  /// Position of the proxy at the last tick, which a log keeps behind the state of the device.
  template <class Visit>
  void visitProxy(Visit& visit) noexcept {
    visit(lastProxy_);
  }

 private:
  TickSigns signsOf(const Pose& pose, const TickConditions& conditions, const DeviceSigns& device) const noexcept;
  /// Velocity of the surface, model units per second, of its own motion or of changes by others.
  DVec3 surfaceVelocity(bool isChanging, double dt_s) noexcept;
  double unitsPerDevice() const noexcept {
    return options_.unitsPerDevice * (options_.limits.handHeld ? law_.options().handGain : 1);
  }
  /// Stiffness of the spring between hand and surface, per displacement of the device.
  double springOfDevice_N_per_mm() const noexcept;

  ForceLaw law_;
  HandForceOptions options_;
  Passivity passivity_;
  ForceGate gate_;
  std::optional<DVec3> lastProxy_;  ///< of the last fresh answer, if it touched
  Contact contact_;
  DVec3 force_N_{0}, torque_mNm_{0};
  double penetration_mm_ = 0;
};

/// One tick from poses to forces.
struct TouchTick {
  ContactQuery& query;
  std::span<const Pose> poses;  ///< one for each hand
  double budget_us = 0;         ///< of the answer; 0: unlimited
  double dt_s = 0;              ///< since the tick before
  bool forcesOn = true;
  const InformationAge* known = nullptr;  ///< null: always current

  TickConditions conditions() const noexcept;
};

/// Asks for all hands at once, computes their forces, calls send() and ends the tick. Each of `hands` has
/// HandForce::feel(). False once the query is lost.
template <class Hands, class Send>
bool runTick(const TouchTick& tick, Hands& hands, Send&& send) noexcept {
  const std::span<const Contact> answers = tick.query.ask(tick.poses, tick.budget_us);
  const TickConditions conditions = tick.conditions();
  const bool isLost = answers.front().lost;
  for (std::size_t i = 0; i < answers.size(); ++i)
    hands[i].feel(answers[i], tick.query.points(i), tick.poses[i], tick.dt_s, conditions);
  send();
  tick.query.endTick();
  return !isLost;
}

}  // namespace palpate
