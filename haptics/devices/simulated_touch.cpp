#include "haptics/devices/simulated_touch.hpp"

#include <algorithm>
#include <glm/common.hpp>

#include "engine/core/error.hpp"

namespace palpate {
namespace {

constexpr double kStep_s = 50e-6;   // twenty steps of physics per tick of 1 kHz
constexpr double kUsedShare = 0.9;  // of the workspace; the rest keeps the hand clear of the stops
constexpr double kMm_per_m = 1000;  // 1 N on 1 kg gives 1 m/s^2

void checkDeviceOption(double value, const char* name, bool mayBeZero = true) {
  if (!std::isfinite(value) || value < 0 || (value == 0 && !mayBeZero))
    throw UsageError("{} is {}; it must be finite and {}", name, value, mayBeZero ? "zero or more" : "above zero");
}

/// Coulomb friction as its maximum impulse in a step: it stops the mass or slows it down, and never reverses it, so
/// that a mass at rest stays exactly at rest until a stronger force acts (Moreau 1988).
DVec3 afterFriction(const DVec3& velocity, double strongestChange) {
  const double speed = glm::length(velocity);
  return speed <= strongestChange ? DVec3(0) : velocity * (1 - strongestChange / speed);
}

}  // namespace

SimulatedTouch::SimulatedTouch(const Path& path, const WorkspaceMap& map, const SimulatedTouchOptions& options)
    : SimulatedTouch([path](double time_s) { return path.at(time_s); }, map, options) {
  pathDuration_s_ = path.duration_s();
}

SimulatedTouch::SimulatedTouch(Intention intention, const WorkspaceMap& map, const SimulatedTouchOptions& options)
    : intention_(std::move(intention)), map_(map), options_(options) {
  checkDeviceOption(options.handStiffness_N_per_mm, "the hand's stiffness (N/mm)");
  checkDeviceOption(options.handDamping_N_s_per_mm, "the hand's damping (N s/mm)");
  checkDeviceOption(options.mass_kg, "the mass of the stylus (kg)", false);
  checkDeviceOption(options.viscosity_N_s_per_mm, "the viscosity of the joints (N s/mm)");
  checkDeviceOption(options.friction_N, "the friction of the joints (N)");
  checkDeviceOption(options.encoderStep_mm, "the encoder's step (mm)", false);
  checkDeviceOption(options.lead_s, "the time before the path begins (s)");
  checkDeviceOption(map.scale, "the scale of the workspace", false);
}

DeviceLimits SimulatedTouch::limits() const { return {.forceDelay_ticks = 1}; }

DeviceState SimulatedTouch::read(double time_s) noexcept {
  if (!begun_ || time_s < now_s_)
    begin(time_s);
  else
    advance(time_s);
  acting_N_ = written_N_;
  return {.position = glm::round(position_mm_ / options_.encoderStep_mm) * options_.encoderStep_mm, .ok = true};
}

bool SimulatedTouch::write(const DVec3& force_N) noexcept {
  const double size_N = glm::length(force_N), peak_N = limits().peakForce_N;
  if (!std::isfinite(size_N)) {
    written_N_ = DVec3(0);
    return false;
  }
  written_N_ = size_N > peak_N ? force_N * (peak_N / size_N) : force_N;  // the amplifiers saturate
  return true;
}

DVec3 SimulatedTouch::intendedAt(double time_s) const noexcept {
  return (intention_(time_s - options_.lead_s) - map_.offset) / map_.scale;
}

void SimulatedTouch::begin(double time_s) noexcept {
  begun_ = true;
  now_s_ = time_s;
  position_mm_ = glm::clamp(intendedAt(time_s), -0.5 * options_.workspace_mm, 0.5 * options_.workspace_mm);
  velocity_mm_per_s_ = acting_N_ = written_N_ = DVec3(0);
}

void SimulatedTouch::advance(double time_s) noexcept {
  const double span_s = time_s - now_s_;
  if (!(span_s > 0)) return;
  constexpr double kRounding = 1e-6;  // a tick of 1 ms is twenty steps, not twenty-one
  const auto steps = static_cast<int>(std::ceil(std::min(span_s / kStep_s, 1e6) - kRounding));
  const DVec3 from_mm = intendedAt(now_s_), way_mm = intendedAt(time_s) - from_mm;
  for (int i = 1; i <= steps; ++i) step(from_mm + way_mm * (double(i) / steps), way_mm / span_s, span_s / steps);
  now_s_ = time_s;
}

// Semi-implicit Euler, with spring and dampers evaluated at the end of the step: stable at any stiffness.
void SimulatedTouch::step(const DVec3& intended_mm, const DVec3& intendedSpeed_mm_per_s, double dt_s) noexcept {
  const double change_per_N = dt_s * kMm_per_m / options_.mass_kg;  // of the velocity, mm/s
  const double spring = options_.handStiffness_N_per_mm, damper = options_.handDamping_N_s_per_mm;
  const DVec3 motors_N = stopped_.load(std::memory_order_relaxed) ? DVec3(0) : acting_N_;
  const DVec3 driving_N = motors_N + spring * (intended_mm - position_mm_) + damper * intendedSpeed_mm_per_s;
  const double resisting_N_s_per_mm = damper + options_.viscosity_N_s_per_mm + spring * dt_s;
  const double share = 1 / (1 + change_per_N * resisting_N_s_per_mm);
  velocity_mm_per_s_ = afterFriction((velocity_mm_per_s_ + change_per_N * driving_N) * share,
                                     change_per_N * options_.friction_N * share);
  position_mm_ += dt_s * velocity_mm_per_s_;
  for (int k = 0; k < 3; ++k) {  // end stops of the arms
    const double end_mm = 0.5 * options_.workspace_mm[k];
    if (std::abs(position_mm_[k]) <= end_mm) continue;
    position_mm_[k] = std::clamp(position_mm_[k], -end_mm, end_mm);
    velocity_mm_per_s_[k] = 0;
  }
}

WorkspaceMap workspaceAround(const Path& path, const ModelScale& scale) {
  DVec3 low = path.keys().front().position, high = low;
  for (const PathKey& key : path.keys()) {
    low = glm::min(low, key.position);
    high = glm::max(high, key.position);
  }
  return workspaceAround(low, high, scale, kUsedShare);
}

WorkspaceMap workspaceAround(const DVec3& low, const DVec3& high, const ModelScale& scale, double usedShare) {
  const DVec3 shares = (high - low) / (usedShare * kTouchWorkspace_mm);
  const double needed = std::max({shares.x, shares.y, shares.z});
  return {.scale = std::max(scale.toUnits(1), needed), .offset = 0.5 * (low + high)};
}

}  // namespace palpate
