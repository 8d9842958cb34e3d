#include "haptics/hand.hpp"

#include <algorithm>
#include <utility>

#include "engine/core/error.hpp"

namespace palpate {
namespace {

constexpr double kSmallestJump_mm = 1;  // encoder steps and late reads look fast from tick to tick

}  // namespace

Hand::Hand(HapticDevice& device, ForceLaw law, const HandOptions& options, double rate_Hz, std::size_t toolPoints)
    : device_(&device),
      map_(options.map),
      limits_(device.limits()),
      passivityMode_(options.passivity.value_or(limits_.handHeld ? PassivityMode::on : PassivityMode::off)),
      force_(std::move(law), {.limits = limits_,
                              .passivity = passivityMode_,
                              .unitsPerDevice = options.map.scale,
                              .rate_Hz = rate_Hz,
                              .toolPoints = toolPoints}),
      clutch_(options.map) {
  if (passivityMode_ == PassivityMode::on && !limits_.handHeld)
    throw UsageError("passivity on: the device '{}' does not yield to forces; use observe", device.name());
}

std::string Hand::faultText() const {
  const std::string text = device_->faultText();
  return text.empty() ? fmt::format("{}: the device failed without saying why", device_->name()) : text;
}

HandCounts Hand::counts() const {
  HandCounts counts{.withheld = force_.withheld()};
  if (passivityMode_ != PassivityMode::off) counts.leastEnergy_mJ = force_.passivity().leastEnergy_mJ();
  return counts;
}

void Hand::begin() {
  force_.begin();
  clutch_ = Clutch(map_, gainOf(force_.law().options()));
  felt_ = {.asked_N = 0, .got_N = 0};
  lastPosition_.reset();
}

void Hand::setForce(const ForceOptions& options) noexcept {
  force_.setOptions(options);
  clutch_.setGain(gainOf(options), state_.position);
}

bool Hand::read(double time_s) noexcept {
  state_ = device_->read(time_s);
  const bool clutched = limits_.buttons > 0 && (state_.buttons & kClutchButton) != 0;
  hip_ = clutch_.toModel(state_.position, clutched);
  if (!state_.ok || !isFinite(hip_)) {
    force_.forget();
    return false;
  }
  if (state_.putDown) {
    force_.lift();
    lastPosition_.reset();
  }
  return true;
}

bool Hand::sculpts() const noexcept {
  return !hasButtons() || ((state_.buttons & kSculptButton) != 0 && !clutch_.isDrawn());
}

void Hand::feel(const Contact& answer, std::span<const PointContact> points, const Pose& pose, double dt_s,
                const TickConditions& conditions) noexcept {
  force_.feel(answer, points, pose, dt_s, conditions,
              {.position = state_.position,
               .rendersForce = state_.rendersForce,
               .isOff = clutch_.isDrawn() || device().isStopped(),
               .jumped = hasJumped(state_.position, dt_s)});
  const Contact& felt = force_.contact();
  const DVec3 toProxy = (felt.proxy - hip_) / clutch_.scale();
  device_->feel(felt.touching ? std::optional(toProxy) : std::nullopt);
}

bool Hand::write() noexcept {
  const DVec3& force_N = force_.force_N();
  written_ = device_->write(force_N);
  force_.acted(written_ ? force_N : DVec3(0));
  felt_ = {.asked_N = force_.law().demand_N(), .got_N = written_ ? glm::length(force_N) : 0};
  return written_;
}

void Hand::takeForceAway() noexcept {
  device_->write(DVec3(0));
  written_ = false;
  felt_.got_N = 0;
}

void Hand::note(TraceRow& row) const noexcept {
  const Contact& felt = force_.contact();
  row.hip = hip_;
  row.proxy = felt.proxy;
  row.normal = felt.normal;
  row.force_N = written_ ? force_.force_N() : DVec3(0);
  row.torque_mNm = written_ ? force_.torque_mNm() : DVec3(0);
  row.penetration_mm = force_.penetration_mm();
  row.contact = felt.touching;
  row.fresh = felt.fresh;
  row.valid = felt.valid && written_;
  row.withheld = force_.isWithheld();
  row.hot = force_.isHot();
  row.age_s = dataAge_s(felt, row.time_s);
  row.putDown = state_.putDown;
  row.neighbours = felt.neighbours;
  row.gpu_us = felt.gpu_us;
}

bool Hand::hasJumped(const DVec3& position, double dt_s) noexcept {
  const double reach_mm = limits_.fastest_mm_per_s * std::max(dt_s, 0.0) + kSmallestJump_mm;
  const bool jumped = lastPosition_ && glm::distance(position, *lastPosition_) > reach_mm;
  lastPosition_ = position;
  return jumped;
}

}  // namespace palpate
