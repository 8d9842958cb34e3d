#include "haptics/hand_force.hpp"

#include <utility>

namespace palpate {
namespace {

/// The answer unchanged, or, if it is a fault or has non-finite numbers, "nothing touched, not valid".
Contact trusted(const Contact& contact, const DVec3& hip) {
  const bool sane = contact.valid && isFinite(contact.proxy) && isFinite(contact.normal) &&
                    isFinite(contact.velocity) && isFinite(contact.force_N.value_or(DVec3(0)));
  return sane ? contact : Contact{.proxy = hip, .lost = contact.lost};
}

}  // namespace

double dataAge_s(const Contact& contact, double now_s) noexcept {
  if (contact.valid && contact.fresh) return 0;
  return contact.valid && contact.dataTime_s >= 0 ? now_s - contact.dataTime_s : -1;
}

TickConditions TouchTick::conditions() const noexcept {
  if (!known) return {.forcesOn = forcesOn};
  const auto now = InformationAge::Clock::now();
  return {.forcesOn = forcesOn && known->isTrue(), .known = known->share(now), .isChanging = known->isChanging(now)};
}

HandForce::HandForce(ForceLaw law, const HandForceOptions& options)
    : law_(std::move(law)),
      options_(options),
      passivity_(options.passivity, options.limits, springOfDevice_N_per_mm()),
      gate_(options.limits, 1 / options.rate_Hz) {
  setOptions(law_.options());
  law_.feelWith(options.toolPoints);
}

void HandForce::setOptions(const ForceOptions& options) noexcept {
  law_.setOptions(options);
  law_.limitTo(options_.limits.peakForce_N, options_.limits.mostStiffness_N_per_mm);
  passivity_.setStiffness(springOfDevice_N_per_mm());
}

void HandForce::begin() {
  law_.reset();
  passivity_ = Passivity(options_.passivity, options_.limits, springOfDevice_N_per_mm());
  gate_ = ForceGate(options_.limits, 1 / options_.rate_Hz);
  lastProxy_.reset();
}

void HandForce::lift() noexcept {
  law_.reset();
  passivity_.lift();
  lastProxy_.reset();
}

void HandForce::feel(const Contact& answer, std::span<const PointContact> points, const Pose& pose, double dt_s,
                     const TickConditions& conditions, const DeviceSigns& device) noexcept {
  contact_ = trusted(answer, pose.hip);
  TickSigns signs = signsOf(pose, conditions, device);
  if (signs.jumped) {
    law_.reset();
    passivity_.lift();
  }
  if (conditions.isChanging) passivity_.changed();
  const DVec3 spring_N = points.empty() ? law_.update(contact_, pose, dt_s) : law_.update(contact_, points, pose, dt_s);
  signs.demand_N = law_.demand_N();
  const DeviceLimits& limits = options_.limits;
  const double mm_per_unit = limits.handHeld ? 1 / unitsPerDevice() : law_.scale().mm_per_unit;
  const DVec3 hand_mm = limits.handHeld ? device.position : mm_per_unit * pose.hip;
  const DVec3 velocity = surfaceVelocity(conditions.isChanging && points.empty(), dt_s);
  const double gate_s = options_.guardsTicks ? dt_s : std::clamp(dt_s, 0.0, 1 / options_.rate_Hz);
  force_N_ = gate_.pass(passivity_.damped(spring_N, hand_mm, dt_s, mm_per_unit * velocity), signs, gate_s);
  const double wanted_N = glm::length(spring_N);
  torque_mNm_ = law_.torque_mNm() * (wanted_N > 0 ? std::min(1.0, glm::length(force_N_) / wanted_N) : gate_.share());
  penetration_mm_ = contact_.touching ? law_.scale().toMm(glm::length(contact_.proxy - pose.hip)) : 0;
}

TickSigns HandForce::signsOf(const Pose& pose, const TickConditions& conditions,
                             const DeviceSigns& device) const noexcept {
  TickSigns signs{.on = conditions.forcesOn && !device.isOff, .known = conditions.known};
  if (!options_.guardsTicks) return signs;
  signs.answered = contact_.valid && device.rendersForce;
  signs.fresh = contact_.fresh;
  signs.jumped = device.jumped;
  if (contact_.dataTime_s >= 0) signs.age_s = pose.time_s - contact_.dataTime_s;
  return signs;
}

// A proxy that slides over a static surface moves along it; its motion across it is that of the surface. An answer from
// old data, whose force may be fading out, does not show this.
DVec3 HandForce::surfaceVelocity(bool isChanging, double dt_s) noexcept {
  if (!contact_.fresh) return contact_.velocity;
  const std::optional<DVec3> last =
      std::exchange(lastProxy_, contact_.touching ? std::optional(contact_.proxy) : std::nullopt);
  if (!isChanging || !contact_.touching || !last || !(dt_s > 0)) return contact_.velocity;
  return contact_.velocity + glm::dot(contact_.proxy - *last, contact_.normal) / dt_s * contact_.normal;
}

// If the workspace is larger than the model, the spring is softer on the device by that factor.
double HandForce::springOfDevice_N_per_mm() const noexcept {
  return law_.options().stiffness_N_per_mm * law_.scale().mm_per_unit * unitsPerDevice();
}

}  // namespace palpate
