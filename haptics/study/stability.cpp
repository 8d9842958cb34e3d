#include "haptics/study/stability.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <limits>
#include <vector>

#include "engine/core/error.hpp"
#include "haptics/servo_loop.hpp"

namespace palpate {
namespace {

constexpr double kRampWait_s = 0.6;  // longer than the ramp
constexpr double kFrom_mm = 2;       // above the surface
constexpr double kPressRest_s = 2;
constexpr double kJudged_s = 0.5;  // judged part of the rest, at its end
constexpr double kLongestDelay_ms = 100;

/// The god-object on a plane or a sphere whose highest point is the origin. y is up.
class ExactSurface final : public OneHandQuery {
 public:
  ExactSurface(StudySurface surface, double radius) : surface_(surface), center_(0, -radius, 0), radius_(radius) {}

  Contact answerTo(const Pose& pose, double) noexcept override {
    const bool plane = surface_ == StudySurface::plane;
    const DVec3 normal = plane ? DVec3(0, 1, 0) : glm::normalize(pose.hip - center_);
    const double depth = plane ? -pose.hip.y : radius_ - glm::distance(pose.hip, center_);
    const bool touching = depth > 0;
    return {.proxy = touching ? pose.hip + depth * normal : pose.hip,
            .normal = normal,
            .touching = touching,
            .fresh = true,
            .valid = true};
  }

 private:
  StudySurface surface_;
  DVec3 center_;
  double radius_;
};

/// Returns another query's answer of some ticks ago, shifted with the HIP, so that force and contact are late.
class DelayedQuery final : public OneHandQuery {
 public:
  DelayedQuery(ContactQuery& query, std::size_t ticks) : query_(query), past_(ticks + 1) {}

  Contact answerTo(const Pose& pose, double budget_us) noexcept override {
    Contact now = query_.query(pose, budget_us);
    now.proxy -= pose.hip;
    if (!begun_) std::fill(past_.begin(), past_.end(), now);
    begun_ = true;
    past_[next_] = now;
    next_ = (next_ + 1) % past_.size();
    Contact answer = past_[next_];  // the oldest
    answer.proxy += pose.hip;
    return answer;
  }

 private:
  ContactQuery& query_;
  std::vector<Contact> past_;  // offsets from the HIP in `proxy`
  std::size_t next_ = 0;
  bool begun_ = false;
};

Path pressAndRest(const StabilityOptions& options) {
  const double down_s = (kFrom_mm + options.depth_mm) / options.approach_mm_per_s;
  const DVec3 above(0, kFrom_mm, 0), below(0, -options.depth_mm, 0);
  return Path(
      {{0, above}, {kRampWait_s, above}, {kRampWait_s + down_s, below}, {kRampWait_s + down_s + kPressRest_s, below}});
}

std::size_t delayTicks(const StabilityOptions& options) {
  if (!(options.delay_ms >= 0 && options.delay_ms <= kLongestDelay_ms))
    throw UsageError("a delay of {} ms: it must be between 0 and {}", options.delay_ms, kLongestDelay_ms);
  return static_cast<std::size_t>(std::llround(options.delay_ms * 1e-3 * options.rate_Hz));
}

}  // namespace

StabilityResult measureStability(const StabilityOptions& options) {
  if (!(options.depth_mm > 0 && options.approach_mm_per_s > 0 && options.radius_mm > options.depth_mm))
    throw UsageError("depth {} mm, radius {} mm, approach {} mm/s: a press goes down, and not past the middle",
                     options.depth_mm, options.radius_mm, options.approach_mm_per_s);
  SimulatedTouchOptions touch = options.touch;
  touch.lead_s = 0;
  SimulatedTouch device(pressAndRest(options), {}, touch);
  ExactSurface surface(options.surface, options.radius_mm);
  const ForceLaw law(
      {.stiffness_N_per_mm = options.stiffness_N_per_mm, .damping_N_s_per_mm = options.damping_N_s_per_mm}, {});
  const ServoOptions servo{.rate_Hz = options.rate_Hz, .duration_s = device.duration_s()};
  // The loop throws for an invalid rate; no delay is computed from it.
  DelayedQuery late(surface, options.rate_Hz > 0 ? delayTicks(options) : 0);
  ServoLoop loop(device, late, law, servo, {.passivity = options.passivity});

  const double judgedFrom_s = device.duration_s() - kJudged_s;
  DVec3 low(std::numeric_limits<double>::infinity()), high(-low);
  const ServoResult run = loop.run([&](const TraceRow& row) {
    if (row.time_s < judgedFrom_s) return;
    low = glm::min(low, device.position_mm());
    high = glm::max(high, device.position_mm());
  });
  const DVec3 motion = high - low;
  StabilityResult result{.restMotion_mm = std::max({motion.x, motion.y, motion.z}),
                         .leastEnergy_mJ = run.counts().leastEnergy_mJ.value_or(0),
                         .peakForce_N = summarize(run.trace()).peakForce_N};
  result.limitCycle = result.restMotion_mm > touch.encoderStep_mm;
  return result;
}

double largestStableStiffness(const StabilityOptions& options, double low_N_per_mm, double high_N_per_mm) {
  constexpr double kPrecision = 1.01;
  if (!(low_N_per_mm > 0 && low_N_per_mm <= high_N_per_mm && std::isfinite(high_N_per_mm)))
    throw UsageError("stiffness from {} to {} N/mm: both must be above 0 and ascend", low_N_per_mm, high_N_per_mm);
  const auto isStable = [&](double stiffness_N_per_mm) {
    StabilityOptions tried = options;
    tried.stiffness_N_per_mm = stiffness_N_per_mm;
    return !measureStability(tried).limitCycle;
  };
  if (!isStable(low_N_per_mm)) return low_N_per_mm;
  if (isStable(high_N_per_mm)) return high_N_per_mm;
  while (high_N_per_mm > kPrecision * low_N_per_mm) {
    const double middle_N_per_mm = std::sqrt(low_N_per_mm * high_N_per_mm);
    (isStable(middle_N_per_mm) ? low_N_per_mm : high_N_per_mm) = middle_N_per_mm;
  }
  return low_N_per_mm;
}

}  // namespace palpate
