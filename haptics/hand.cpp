#include "haptics/hand.hpp"

#include <algorithm>
#include <utility>

#include "engine/core/error.hpp"

namespace palpate {
namespace {

constexpr double kSmallestJump_mm = 1;  // encoder steps and late reads look fast from tick to tick

/// The answer unchanged, or, if it is a fault or has non-finite numbers, "nothing touched, not valid".
Contact trusted(const Contact& contact, const DVec3& hip) {
  const bool sane = contact.valid && isFinite(contact.proxy) && isFinite(contact.normal) &&
                    isFinite(contact.velocity) && isFinite(contact.force_N.value_or(DVec3(0)));
  return sane ? contact : Contact{.proxy = hip};
}

}  // namespace

Hand::Hand(HapticDevice& device, ForceLaw law, const HandOptions& options, double rate_Hz, std::size_t toolPoints)
    : device_(&device),
      law_(std::move(law)),
      options_(options),
      rate_Hz_(rate_Hz),
      limits_(device.limits()),
      passivityMode_(options.passivity.value_or(limits_.handHeld ? PassivityMode::on : PassivityMode::off)),
      passivity_(passivityMode_, limits_, springOfDevice_N_per_mm()),
      gate_(limits_, 1 / rate_Hz),
      clutch_(options.map) {
  setForce(law_.options());
  law_.feelWith(toolPoints);
  if (passivityMode_ == PassivityMode::on && !limits_.handHeld)
    throw UsageError("passivity on: the device '{}' does not yield to forces; use observe", device.name());
}

std::string Hand::faultText() const {
  const std::string text = device_->faultText();
  return text.empty() ? fmt::format("{}: the device failed without saying why", device_->name()) : text;
}

HandCounts Hand::counts() const {
  HandCounts counts{.withheld = gate_.counts()};
  if (passivityMode_ != PassivityMode::off) counts.leastEnergy_mJ = passivity_.leastEnergy_mJ();
  return counts;
}

void Hand::setForce(const ForceOptions& options) noexcept {
  law_.setOptions(options);
  law_.limitTo(limits_.peakForce_N, limits_.mostStiffness_N_per_mm);
  passivity_.setStiffness(springOfDevice_N_per_mm());
}

void Hand::begin() {
  law_.reset();
  passivity_ = Passivity(passivityMode_, limits_, springOfDevice_N_per_mm());
  gate_ = ForceGate(limits_, 1 / rate_Hz_);
  clutch_ = Clutch(options_.map);
  felt_ = {.asked_N = 0, .got_N = 0};
  lastProxy_.reset();
  lastPosition_.reset();
}

bool Hand::read(double time_s) noexcept {
  state_ = device_->read(time_s);
  const bool clutched = limits_.buttons > 0 && (state_.buttons & kClutchButton) != 0;
  hip_ = clutch_.toModel(state_.position, clutched);
  if (!state_.ok || !isFinite(hip_)) {
    law_.reset();
    return false;
  }
  if (state_.putDown) {
    law_.reset();
    passivity_.lift();
    lastProxy_.reset();
    lastPosition_.reset();
  }
  return true;
}

bool Hand::sculpts() const noexcept {
  return !hasButtons() || ((state_.buttons & kSculptButton) != 0 && !clutch_.isDrawn());
}

void Hand::feel(const Contact& answer, std::span<const PointContact> points, const Pose& pose, double dt_s,
                const TickConditions& conditions) noexcept {
  contact_ = trusted(answer, hip_);
  const DVec3 toProxy = (contact_.proxy - hip_) / options_.map.scale;
  device_->feel(contact_.touching ? std::optional(toProxy) : std::nullopt);
  force_N_ = forceFor(points, pose, dt_s, conditions);
}

bool Hand::write() noexcept {
  written_ = device_->write(force_N_);
  passivity_.acted(written_ ? force_N_ : DVec3(0));
  felt_ = {.asked_N = law_.demand_N(), .got_N = written_ ? glm::length(force_N_) : 0};
  return written_;
}

void Hand::takeForceAway() noexcept {
  device_->write(DVec3(0));
  written_ = false;
  felt_.got_N = 0;
}

void Hand::note(TraceRow& row) const noexcept {
  row.hip = hip_;
  row.proxy = contact_.proxy;
  row.normal = contact_.normal;
  row.force_N = written_ ? force_N_ : DVec3(0);
  row.torque_mNm = written_ ? torque_mNm_ : DVec3(0);
  row.penetration_mm = contact_.touching ? law_.scale().toMm(glm::length(contact_.proxy - hip_)) : 0;
  row.contact = contact_.touching;
  row.fresh = contact_.fresh;
  row.valid = contact_.valid && written_;
  row.putDown = state_.putDown;
  row.neighbours = contact_.neighbours;
  row.gpu_us = contact_.gpu_us;
}

DVec3 Hand::forceFor(std::span<const PointContact> points, const Pose& pose, double dt_s,
                     const TickConditions& conditions) noexcept {
  TickSigns signs{.on = conditions.forcesOn && !clutch_.isDrawn() && !device().isStopped(),
                  .answered = contact_.valid && state_.rendersForce,
                  .fresh = contact_.fresh,
                  .jumped = hasJumped(state_.position, dt_s),
                  .known = conditions.known};
  if (contact_.dataTime_s >= 0) signs.age_s = pose.time_s - contact_.dataTime_s;
  if (signs.jumped) {
    law_.reset();
    passivity_.lift();
  }
  if (conditions.isChanging) passivity_.changed();
  const DVec3 spring_N = points.empty() ? law_.update(contact_, pose, dt_s) : law_.update(contact_, points, pose, dt_s);
  signs.demand_N = law_.demand_N();
  const double mm_per_unit = limits_.handHeld ? 1 / options_.map.scale : law_.scale().mm_per_unit;
  const DVec3 hand_mm = limits_.handHeld ? state_.position : mm_per_unit * pose.hip;
  const DVec3 velocity = surfaceVelocity(conditions.isChanging && points.empty(), dt_s);
  const DVec3 force_N = gate_.pass(passivity_.damped(spring_N, hand_mm, dt_s, mm_per_unit * velocity), signs, dt_s);
  const double wanted_N = glm::length(spring_N);
  torque_mNm_ = law_.torque_mNm() * (wanted_N > 0 ? std::min(1.0, glm::length(force_N) / wanted_N) : gate_.share());
  return force_N;
}

// A proxy that slides over a static surface moves along it; its motion across it is that of the surface. An answer from
// old data, whose force may be fading out, does not show this.
DVec3 Hand::surfaceVelocity(bool isChanging, double dt_s) noexcept {
  if (!contact_.fresh) return contact_.velocity;
  const std::optional<DVec3> last =
      std::exchange(lastProxy_, contact_.touching ? std::optional(contact_.proxy) : std::nullopt);
  if (!isChanging || !contact_.touching || !last || !(dt_s > 0)) return contact_.velocity;
  return contact_.velocity + glm::dot(contact_.proxy - *last, contact_.normal) / dt_s * contact_.normal;
}

// If the workspace is larger than the model, the spring is softer on the device by that factor.
double Hand::springOfDevice_N_per_mm() const noexcept {
  return law_.options().stiffness_N_per_mm * law_.scale().mm_per_unit * options_.map.scale;
}

bool Hand::hasJumped(const DVec3& position, double dt_s) noexcept {
  const double reach_mm = limits_.fastest_mm_per_s * std::max(dt_s, 0.0) + kSmallestJump_mm;
  const bool jumped = lastPosition_ && glm::distance(position, *lastPosition_) > reach_mm;
  lastPosition_ = position;
  return jumped;
}

}  // namespace palpate
