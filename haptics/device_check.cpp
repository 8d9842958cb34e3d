#include "haptics/device_check.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include "engine/core/error.hpp"
#include "haptics/servo_loop.hpp"

namespace palpate {

namespace {

constexpr double kPower_s = 0.015, kMean_s = 0.1;  // time constants

constexpr double kWallBelow_mm = 5;  // the hand when the wall appears, so that it is approached from free space
constexpr double kMove_mm = 20;      // in a direction; small devices reach 35 mm from their middle
constexpr double kClear_mm = 2;      // above the wall: lifted
constexpr double kMinLean_N = 0.2;   // a hand that leans
constexpr double kMaxShare = 0.8;    // of the peak force
constexpr double kStepRamp_s = 0.2;  // from one stiffness to the next: no knock in the hand
constexpr double kStepHold_s = 0.5;  // leaned on at the whole stiffness
constexpr double kMaxStepFactor = 2;
constexpr double kHumFade_s = 0.03;  // of the force after an oscillation
constexpr double kPause_s = 0.05;    // between two poses, from which on the hand may be anywhere (ForceGate)

/// Unit vector along an axis as in DeviceCheckResult::axes.
DVec3 along(int axis) {
  DVec3 vector(0);
  vector[std::abs(axis) - 1] = axis < 0 ? -1 : 1;
  return vector;
}

/// Up, in the axes of the pose. If the hand was not moved up, it follows from the two other directions, since up is
/// towards the user times right; else it is +y.
DVec3 upOf(const std::array<int, 3>& axes) {
  const auto [right, up, towards] = axes;
  if (up != 0) return along(up);
  if (right == 0 || towards == 0 || std::abs(right) == std::abs(towards)) return {0, 1, 0};
  return glm::cross(along(towards), along(right));
}

/// A device whose buttons do nothing: the clutch would hide the motion of the hand.
class WithoutButtons final : public HapticDevice {
 public:
  explicit WithoutButtons(HapticDevice& device) : device_(device) {}
  std::string_view name() const override { return device_.name(); }
  DeviceLimits limits() const override { return device_.limits(); }
  bool paces() const override { return device_.paces(); }
  bool pace(double rate_Hz, const std::function<bool()>& tick) override { return device_.pace(rate_Hz, tick); }
  DeviceState read(double time_s) noexcept override {
    DeviceState state = device_.read(time_s);
    state.buttons = 0;
    return state;
  }
  bool write(const DVec3& force_N) noexcept override { return device_.write(force_N); }
  void emergencyStop() noexcept override { device_.emergencyStop(); }
  bool isStopped() const noexcept override { return device_.isStopped(); }
  void resume() noexcept override { device_.resume(); }
  std::string faultText() const override { return device_.faultText(); }

 private:
  HapticDevice& device_;
};

DeviceCheckStage stageAfter(DeviceCheckStage stage) {
  return static_cast<DeviceCheckStage>(static_cast<std::uint8_t>(stage) + 1);
}

}  // namespace

bool Oscillation::update(double depth_mm, double stiffness_N_per_mm, double dt_s) noexcept {
  if (!known_) position_mm_ = depth_mm;
  known_ = true;
  if (!(dt_s > 0)) return false;
  constexpr double kTime_s = 1 / (2 * std::numbers::pi * kCorner_Hz);
  const double kept = kTime_s / (kTime_s + dt_s);
  const double once_mm = kept * (once_mm_ + depth_mm - position_mm_);
  fast_mm_ = kept * (fast_mm_ + once_mm - once_mm_);
  once_mm_ = once_mm;
  position_mm_ = depth_mm;
  power_mm2_ += std::min(1.0, dt_s / kPower_s) * (fast_mm_ * fast_mm_ - power_mm2_);
  mean_N_ += std::min(1.0, dt_s / kMean_s) * (stiffness_N_per_mm * std::max(0.0, depth_mm) - mean_N_);
  const double size_N = stiffness_N_per_mm * std::sqrt(power_mm2_);
  isOn_ = size_N > std::max(kSmallest_N, (isOn_ ? kEnds : kBegins) * mean_N_);
  maxPower_mm2_ = std::max(maxPower_mm2_, power_mm2_);
  const bool isSustained = isOn_ && power_mm2_ > kSustained * maxPower_mm2_;
  if (!isSustained) maxPower_mm2_ = power_mm2_;
  sustained_s_ = isSustained ? sustained_s_ + dt_s : 0;
  return sustained_s_ >= kLasts_s;
}

std::string_view instructionOf(DeviceCheckStage stage) {
  switch (stage) {
    case DeviceCheckStage::freeSpace:
      return "Hold the stylus still in the middle of its workspace.";
    case DeviceCheckStage::right:
      return "Move the stylus 3 cm to the right.";
    case DeviceCheckStage::up:
      return "Move the stylus 3 cm up.";
    case DeviceCheckStage::towards:
      return "Move the stylus 3 cm towards you.";
    case DeviceCheckStage::lean:
      return "There is a wall 5 mm below the stylus. Lean on it gently and stay: it becomes stiffer until it hums.";
    case DeviceCheckStage::lift:
      return "The wall hummed, and the force is off. Lift the stylus off the wall.";
    case DeviceCheckStage::leanAgain:
      return "Lean on the wall once more: this stiffness should not hum.";
    case DeviceCheckStage::done:
      return "The test is complete.";
  }
  return {};
}

std::optional<double> DeviceCheckResult::offeredStiffness_N_per_mm() const {
  if (!fault.empty() || !stableStiffness_N_per_mm) return std::nullopt;
  return kStiffnessMargin * *stableStiffness_N_per_mm;
}

std::optional<DeviceAxes> DeviceCheckResult::offeredAxes() const {
  if (!fault.empty() || axesAreRight()) return std::nullopt;
  return DeviceAxes::of(axes);
}

DeviceCheckQuery::DeviceCheckQuery(const DeviceCheckOptions& options, const DeviceLimits& limits)
    : options_(options), most_N_(kMaxShare * limits.peakForce_N) {
  const bool ascends = options.softest_N_per_mm > 0 && options.stiffest_N_per_mm >= options.softest_N_per_mm &&
                       std::isfinite(options.stiffest_N_per_mm) && options.factor > 1 &&
                       options.factor <= kMaxStepFactor;
  if (!ascends)
    throw UsageError(
        "a wall from {} to {} N/mm in steps by a factor of {}: stiffness must be above 0 and ascend, by {} "
        "at most",
        options.softest_N_per_mm, options.stiffest_N_per_mm, options.factor, kMaxStepFactor);
  if (!(options.freeSpace_s > 0 && options.stageTimeout_s > 0))
    throw UsageError("{} s in free space and {} s for each step: both must be above 0", options.freeSpace_s,
                     options.stageTimeout_s);
  options_.stiffest_N_per_mm = std::min(options.stiffest_N_per_mm, limits.mostStiffness_N_per_mm);
  options_.softest_N_per_mm = std::min(options.softest_N_per_mm, options_.stiffest_N_per_mm);
  stiffness_N_per_mm_ = now_N_per_mm_ = options_.softest_N_per_mm;
}

void DeviceCheckQuery::enter(DeviceCheckStage stage, const Pose& pose) noexcept {
  since_s_ = pose.time_s;
  from_mm_ = pose.hip;
  if (stage == DeviceCheckStage::lean) {
    up_ = upOf(result_.axes);
    wall_mm_ = glm::dot(pose.hip, up_) - kWallBelow_mm;
  }
  if (stage == DeviceCheckStage::lean || stage == DeviceCheckStage::leanAgain) oscillation_.reset();
  share_ = 1;
  leaned_s_ = 0;
  stage_.store(stage, std::memory_order_relaxed);
  if (stage == DeviceCheckStage::done) done_.store(true, std::memory_order_relaxed);
}

void DeviceCheckQuery::freeSpace(const Pose& pose, double dt_s) noexcept {
  ++result_.poses;
  result_.largestGap_s = std::max(result_.largestGap_s, dt_s);
  result_.freeSpace_s = pose.time_s - since_s_;
  result_.changedPoses += pose.hip != before_[0];
  result_.freeForce_N = std::max(result_.freeForce_N, pose.felt.got_N);
  // The second difference of white noise has six times its variance; a hand's motion has hardly any at 1 kHz.
  if (result_.poses > 2) {
    const DVec3 curvature_mm = pose.hip - 2.0 * before_[0] + before_[1];
    curvature2_mm2_ += curvature_mm * curvature_mm;
    const double most_mm2 = std::max({curvature2_mm2_.x, curvature2_mm2_.y, curvature2_mm2_.z});
    result_.noise_mm = std::sqrt(most_mm2 / (6 * static_cast<double>(result_.poses - 2)));
  }
  if (result_.freeSpace_s >= options_.freeSpace_s) enter(DeviceCheckStage::right, pose);
}

void DeviceCheckQuery::direction(const Pose& pose, int which) noexcept {
  const DVec3 way_mm = pose.hip - from_mm_;
  int most = 0;
  for (int k = 1; k < 3; ++k)
    if (std::abs(way_mm[k]) > std::abs(way_mm[most])) most = k;
  const bool isMoved = std::abs(way_mm[most]) >= kMove_mm;
  if (isMoved) result_.axes[static_cast<std::size_t>(which)] = way_mm[most] > 0 ? most + 1 : -(most + 1);
  if (isMoved || pose.time_s - since_s_ > options_.stageTimeout_s) enter(stageAfter(stage()), pose);
}

void DeviceCheckQuery::nextStep() noexcept {
  result_.stableStiffness_N_per_mm = stiffness_N_per_mm_;
  leaned_s_ = 0;
  stiffness_N_per_mm_ = std::min(stiffness_N_per_mm_ * options_.factor, options_.stiffest_N_per_mm);
}

// Lowers the force to zero after an oscillation. The stiffness before it no longer counts as stable.
void DeviceCheckQuery::fade(const Pose& pose, double dt_s) noexcept {
  if (share_ == 1) {
    humBegan_s_ = pose.time_s - oscillation_.duration_s();
    result_.oscillated = true;
    auto& stable = result_.stableStiffness_N_per_mm;
    if (stage() == DeviceCheckStage::leanAgain && stable) stable = *stable / options_.factor;
    if (stable && *stable < options_.softest_N_per_mm) stable.reset();
  }
  share_ = std::max(0.0, share_ - dt_s / kHumFade_s);
  if (share_ > 0) return;
  result_.oscillation_s = std::max(result_.oscillation_s, pose.time_s - humBegan_s_);
  enter(result_.stableStiffness_N_per_mm ? DeviceCheckStage::lift : DeviceCheckStage::done, pose);
}

void DeviceCheckQuery::lean(const Pose& pose, double dt_s) noexcept {
  const double rise = (options_.factor - 1) * stiffness_N_per_mm_ * dt_s / kStepRamp_s;
  now_N_per_mm_ = std::min(stiffness_N_per_mm_, now_N_per_mm_ + rise);
  if (oscillation_.update(depth_mm_, now_N_per_mm_, dt_s) || share_ < 1) return fade(pose, dt_s);
  const double got_N = pose.felt.got_N;
  if (got_N >= kMinLean_N && got_N <= most_N_ && oscillation_.duration_s() == 0) {
    if (now_N_per_mm_ == stiffness_N_per_mm_) leaned_s_ += dt_s;
    result_.triedStiffness_N_per_mm = std::max(result_.triedStiffness_N_per_mm, now_N_per_mm_);
  }
  const bool isLast = stage() == DeviceCheckStage::leanAgain || stiffness_N_per_mm_ >= options_.stiffest_N_per_mm;
  if (leaned_s_ >= kStepHold_s) {
    nextStep();
    since_s_ = pose.time_s;
    if (isLast) return enter(DeviceCheckStage::done, pose);
  }
  if (pose.time_s - since_s_ > options_.stageTimeout_s) enter(DeviceCheckStage::done, pose);
}

void DeviceCheckQuery::lift(const Pose& pose) noexcept {
  if (pose.time_s - since_s_ > options_.stageTimeout_s) return enter(DeviceCheckStage::done, pose);
  if (depth_mm_ > -kClear_mm) return;
  stiffness_N_per_mm_ = now_N_per_mm_ = *result_.stableStiffness_N_per_mm;
  enter(DeviceCheckStage::leanAgain, pose);
}

void DeviceCheckQuery::advance(const Pose& pose, double dt_s) noexcept {
  if (dt_s > kPause_s && stage() != DeviceCheckStage::freeSpace) {  // the machine slept: the step begins again
    since_s_ += dt_s;
    leaned_s_ = 0;
    oscillation_.reset();
    return;
  }
  switch (stage()) {
    case DeviceCheckStage::freeSpace:
      return freeSpace(pose, dt_s);
    case DeviceCheckStage::right:
      return direction(pose, 0);
    case DeviceCheckStage::up:
      return direction(pose, 1);
    case DeviceCheckStage::towards:
      return direction(pose, 2);
    case DeviceCheckStage::lean:
    case DeviceCheckStage::leanAgain:
      return lean(pose, dt_s);
    case DeviceCheckStage::lift:
      return lift(pose);
    case DeviceCheckStage::done:
      return;
  }
}

Contact DeviceCheckQuery::answerTo(const Pose& pose, double /*budget_us*/) noexcept {
  if (!hasBegun_) {
    enter(DeviceCheckStage::freeSpace, pose);
    last_ = pose;
    before_.fill(pose.hip);
    hasBegun_ = true;
  }
  if (options_.stop && options_.stop->load(std::memory_order_relaxed)) enter(DeviceCheckStage::done, pose);
  result_.peakForce_N = std::max(result_.peakForce_N, pose.felt.got_N);
  depth_mm_ = wall_mm_ - glm::dot(pose.hip, up_);
  advance(pose, pose.time_s - last_.time_s);
  before_ = {pose.hip, before_[0]};
  last_ = pose;
  shown_.store(now_N_per_mm_, std::memory_order_relaxed);
  const bool isWall = stage() == DeviceCheckStage::lean || stage() == DeviceCheckStage::leanAgain;
  depth_mm_ = wall_mm_ - glm::dot(pose.hip, up_);
  const bool touching = isWall && depth_mm_ > 0;
  return {.proxy = touching ? pose.hip + depth_mm_ * up_ : pose.hip,
          .normal = up_,
          .touching = touching,
          .fresh = true,
          .valid = true,
          .force_N = touching ? share_ * now_N_per_mm_ * depth_mm_ * up_ : DVec3(0)};
}

DeviceCheckResult checkDevice(HapticDevice& device, DeviceCheckQuery& query) {
  constexpr double kLongest_s = 600;  // in virtual time
  const ForceLaw law({.stiffness_N_per_mm = query.options().stiffest_N_per_mm, .damping_N_s_per_mm = 0}, {});
  const DeviceCheckOptions& options = query.options();
  WithoutButtons held(device);
  ServoLoop loop(held, query, law,
                 {.rate_Hz = options.rate_Hz,
                  .duration_s = options.realtime ? 0 : kLongest_s,
                  .endless = options.realtime,
                  .realtime = options.realtime,
                  .clock = options.clock,
                  .stop = &query.isDone()},
                 {.passivity = PassivityMode::observe});  // a damper would hide the limit
  const ServoResult run = loop.run();
  DeviceCheckResult result = query.result();
  result.leastEnergy_mJ = run.counts().leastEnergy_mJ.value_or(0);
  if (run.deviceFailed) result.fault = run.fault;
  return result;
}

}  // namespace palpate
