#include "haptics/force_law.hpp"

#include <algorithm>

#include "engine/core/error.hpp"

namespace palpate {
namespace {

/// A late tick must not make up for the lost time in one jump: the rise counts at most this time.
constexpr double kLongestRise_s = 0.002;
/// Share of the maximum rise while others change the surface: a Touch's whole force then takes 55 ms.
constexpr double kChangingRise = 0.1;

void checkForceOption(double value, const char* name, bool mayBeInfinite) {
  if (!(value >= 0) || (!mayBeInfinite && !std::isfinite(value)))
    throw UsageError("{} is {}; it must be {}zero or more", name, value, mayBeInfinite ? "" : "finite and ");
}

}  // namespace

ForceLaw::ForceLaw(const ForceOptions& options, const ModelScale& scale) : options_(options), scale_(scale) {
  checkForceOption(options.stiffness_N_per_mm, "stiffness (N/mm)", false);
  checkForceOption(options.damping_N_s_per_mm, "damping (N s/mm)", false);
  checkForceOption(options.maxForce_N, "the maximum force (N)", true);
  checkForceOption(options.maxRise_N_per_s, "the maximum rise of force (N/s)", true);
  checkForceOption(options.maxSurfacePower_W, "the maximum power of the surface (W)", true);
}

void ForceLaw::limitTo(double peakForce_N, double stiffness_N_per_mm) noexcept {
  // Written so that a limit that is not a number allows no force at all.
  const auto limited = [](double wanted, double most) { return most >= 0 ? std::min(wanted, most) : 0; };
  options_.maxForce_N = limited(options_.maxForce_N, peakForce_N);
  options_.stiffness_N_per_mm = limited(options_.stiffness_N_per_mm, stiffness_N_per_mm);
}

void ForceLaw::reset() noexcept {
  rates_.reset();
  for (Rates& rates : pointRates_) rates.reset();
  force_N_ = torque_mNm_ = DVec3(0);
  demand_N_ = 0;
  isLettingGo_ = false;
}

// F = k dx + d dx', dx from the HIP to the proxy (god-object with a virtual coupling; Zilles, Salisbury 1995). dx' is a
// backward difference, so it needs two ticks of contact. On a moving surface dx' is limited to the relative speed of
// hand and surface: anything faster results from points that another frame has exchanged, and must not be damped.
DVec3 ForceLaw::spring(const Contact& contact, const DVec3& hip, double dt_s, Rates& rates) const noexcept {
  const DVec3 stretch_mm = (contact.proxy - hip) * scale_.mm_per_unit;
  DVec3 rate_mm_per_s = rates.stretch.add(stretch_mm, dt_s);
  const DVec3 hand_mm_per_s = rates.hand.add(hip * scale_.mm_per_unit, dt_s);
  if (contact.velocity != DVec3(0)) {
    const double apart_mm_per_s = glm::length(hand_mm_per_s - contact.velocity * scale_.mm_per_unit);
    const double size_mm_per_s = glm::length(rate_mm_per_s);
    if (size_mm_per_s > apart_mm_per_s) rate_mm_per_s *= apart_mm_per_s / size_mm_per_s;
  }
  return options_.stiffness_N_per_mm * stretch_mm + options_.damping_N_s_per_mm * rate_mm_per_s;
}

DVec3 ForceLaw::update(const Contact& contact, const Pose& pose, double dt_s) noexcept {
  if (!contact.valid || !contact.touching) {
    isLettingGo_ = isLettingGo_ || contact.isWithin;
    if (contact.valid && isLettingGo_) return letGo(dt_s);
    reset();
    return DVec3(0);
  }
  if (contact.force_N) {
    rates_.reset();
    if (!isFinite(contact.torque_mNm)) {
      reset();
      return DVec3(0);
    }
    const DVec3 felt_N = given(*contact.force_N, contact.velocity, dt_s);
    const double wanted_N = glm::length(*contact.force_N);
    torque_mNm_ = (wanted_N > 0 ? std::min(1.0, glm::length(felt_N) / wanted_N) : 1) * contact.torque_mNm;
    return felt_N;
  }
  torque_mNm_ = DVec3(0);
  const DVec3 force_N = spring(contact, pose.hip, dt_s, rates_);
  if (custom_) return given(custom_.function(custom_.user, contact, pose, dt_s, force_N), contact.velocity, dt_s);
  if (!isFinite(force_N) || !isFinite(contact.normal) || !std::isfinite(dt_s)) {
    reset();
    return DVec3(0);
  }

  demand_N_ = glm::length(force_N);
  // A surface only pushes. Friction depends on the normal force, so without one the tangential part is dropped, too.
  const auto pushes = [&](const DVec3& f) { return glm::dot(f, contact.normal) > 0; };
  const DVec3 result = pushes(force_N) ? limited(force_N, contact.velocity, dt_s) : DVec3(0);
  force_N_ = pushes(result) ? result : DVec3(0);
  return force_N_;
}

// A surface that ends under a loaded hand, or is not found any more, must not cause a knock.
DVec3 ForceLaw::letGo(double dt_s) noexcept {
  const DVec3 before_N = force_N_;
  reset();
  if (before_N == DVec3(0) || !std::isfinite(dt_s)) return DVec3(0);
  force_N_ = before_N;
  isLettingGo_ = true;
  force_N_ = limited(DVec3(0), DVec3(0), dt_s);
  return force_N_;
}

// Such a force may also pull, as of matter that a ball carries along.
DVec3 ForceLaw::given(const DVec3& force_N, const DVec3& velocity, double dt_s) noexcept {
  if (!isFinite(force_N) || !std::isfinite(dt_s)) {
    reset();
    return DVec3(0);
  }
  demand_N_ = glm::length(force_N);
  force_N_ = limited(force_N, velocity, dt_s);
  return force_N_;
}

DVec3 ForceLaw::update(const Contact& whole, std::span<const PointContact> points, const Pose& pose,
                       double dt_s) noexcept {
  DVec3 asked_N(0), sum_N(0), torque_mNm(0);
  const bool touches = whole.valid && whole.touching;
  for (std::size_t i = 0; i < points.size() && i < pointRates_.size(); ++i)
    isLettingGo_ = isLettingGo_ || (pointRates_[i].stretch.isKnown() && points[i].contact.isWithin);
  if (!touches && whole.valid && isLettingGo_) return letGo(dt_s);
  if (!touches) points = {};
  for (std::size_t i = 0; i < points.size() && i < pointRates_.size(); ++i) {
    const PointContact& point = points[i];
    if (!point.contact.touching) {
      pointRates_[i].reset();
      continue;
    }
    const DVec3 force_N = point.share * spring(point.contact, point.hip, dt_s, pointRates_[i]);
    asked_N += force_N;
    // NaN propagates into the sum.
    if (glm::dot(force_N, point.contact.normal) <= 0) continue;
    sum_N += force_N;
    torque_mNm += glm::cross(scale_.mm_per_unit * (point.hip - pose.hip), force_N);
  }
  if (points.empty() || !isFinite(sum_N) || !isFinite(torque_mNm) || !std::isfinite(dt_s)) {
    reset();
    return DVec3(0);
  }

  demand_N_ = glm::length(asked_N);
  const double wanted_N = glm::length(sum_N);
  const DVec3 result = limited(sum_N, whole.velocity, dt_s);
  force_N_ = glm::dot(result, sum_N) > 0 ? result : DVec3(0);
  const double share = wanted_N > 0 ? std::min(1.0, glm::length(force_N_) / wanted_N) : 1;
  torque_mNm_ = share * torque_mNm;
  return force_N_;
}

// `velocity`: of the surface, model units per second.
DVec3 ForceLaw::limited(const DVec3& target_N, const DVec3& velocity, double dt_s) noexcept {
  const double wanted_N = glm::length(target_N);
  if (!std::isfinite(wanted_N)) return DVec3(0);  // the squares overflowed
  double size_N = std::min(wanted_N, options_.maxForce_N);
  const double power_W = glm::dot(target_N, scale_.mm_per_unit * velocity) * 1e-3;  // at the wanted force
  if (power_W > 0) size_N = std::min(size_N, wanted_N * options_.maxSurfacePower_W / power_W);
  const DVec3 clamped_N = wanted_N > 0 ? target_N * (size_N / wanted_N) : DVec3(0);
  // The step begins at the last force, shrunk to the new size if it was larger: a decrease is immediate, a rotation is
  // not.
  const double last_N = glm::length(force_N_);
  const DVec3 from_N = last_N > size_N && !isLettingGo_ ? force_N_ * (size_N / last_N) : force_N_;
  const DVec3 step_N = clamped_N - from_N;
  const double rise_N_per_s = (isChanging_ ? kChangingRise : 1) * options_.maxRise_N_per_s;
  const double longest_N = dt_s > 0 ? rise_N_per_s * std::min(dt_s, kLongestRise_s) : 0;
  const double length_N = glm::length(step_N);
  if (length_N > longest_N) return from_N + step_N * (longest_N / length_N);
  isLettingGo_ = false;
  return clamped_N;
}

}  // namespace palpate
