#include "haptics/force_law.hpp"

#include <algorithm>
#include <utility>

#include "engine/core/error.hpp"

namespace palpate {

namespace {

constexpr double kWindow_s = 0.001 * (1 - 1e-6);  // tolerance for whole ticks of times that are not exact in binary

/// A late tick must not make up for the lost time in one jump: the rise counts at most this time.
constexpr double kLongestRise_s = 0.002;
/// Share of the maximum rise that a surface has alone, with the hand at rest: a Touch's whole force then takes 55 ms.
constexpr double kSurfaceShare = 0.1;

void checkForceOption(double value, const char* name, bool mayBeInfinite) {
  if (!(value >= 0) || (!mayBeInfinite && !std::isfinite(value)))
    throw UsageError("{} is {}; it must be {}zero or more", name, value, mayBeInfinite ? "" : "finite and ");
}

double inTime(double rate_N_per_s, double dt_s) { return dt_s > 0 ? rate_N_per_s * std::min(dt_s, kLongestRise_s) : 0; }

DVec3 towards(const DVec3& from, const DVec3& to, double longest) {
  const double length = glm::distance(from, to);
  return length > longest ? glm::mix(from, to, longest / length) : to;
}

}  // namespace

DVec3 RateEstimate::add(const DVec3& value, double dt_s) noexcept {
  newest_ = (newest_ + 1) % samples_.size();
  samples_[newest_] = {value, dt_s};
  if (count_ < samples_.size()) ++count_;

  double span_s = 0;
  std::size_t at = newest_;
  for (std::size_t back = 1; back < count_ && span_s < kWindow_s; ++back) {
    span_s += samples_[at].dt_s;
    at = (at + samples_.size() - 1) % samples_.size();
  }
  return span_s > 0 ? (value - samples_[at].value) / span_s : DVec3(0);
}

void validate(const ForceOptions& options) {
  checkForceOption(options.stiffness_N_per_mm, "stiffness (N/mm)", false);
  checkForceOption(options.damping_N_s_per_mm, "damping (N s/mm)", false);
  checkForceOption(options.maxForce_N, "the maximum force (N)", true);
  checkForceOption(options.maxRise_N_per_s, "the maximum rise of force (N/s)", true);
  checkForceOption(options.maxSurfacePower_W, "the maximum power of the surface (W)", true);
}

ForceLaw::ForceLaw(const ForceOptions& options, const ModelScale& scale) : options_(options), scale_(scale) {
  validate(options);
}

void ForceLaw::limitTo(double peakForce_N, double stiffness_N_per_mm) noexcept {
  // Written so that a limit that is not a number allows no force at all.
  const auto limited = [](double wanted, double most) { return most >= 0 ? std::min(wanted, most) : 0; };
  options_.maxForce_N = limited(options_.maxForce_N, peakForce_N);
  // A hand that moves the stylus further than itself feels a stiffer spring.
  const double mostOfStylus_N_per_mm = stiffness_N_per_mm / std::max(1.0, options_.handGain);
  options_.stiffness_N_per_mm = limited(options_.stiffness_N_per_mm, mostOfStylus_N_per_mm);
}

void ForceLaw::reset() noexcept {
  point_ = {};
  std::fill(toolPoints_.begin(), toolPoints_.end(), Point{});
  followed_N_ = force_N_ = torque_mNm_ = DVec3(0);
  hand_ = {};
  demand_N_ = asked_N_ = 0;
  isMoveKnown_ = false;
}

// On a surface at rest, a spring and a damper with this motion of the hand would change by as much, in the other
// direction. A point that touches nothing has no damper, and one that begins to touch has it from the second tick on.
void ForceLaw::move(Point& point, const DVec3& hip, bool touching, double share, double dt_s) noexcept {
  const DVec3 hip_mm = hip * scale_.mm_per_unit;
  DVec3 change_N = options_.stiffness_N_per_mm * (hip_mm - point.hip_mm);
  if (touching) {
    const DVec3 last_mm_per_s = std::exchange(point.hand_mm_per_s, point.hand.add(hip_mm, dt_s));
    change_N += options_.damping_N_s_per_mm * (point.hand_mm_per_s - last_mm_per_s);
  } else {
    point.stretch.reset(), point.hand.reset();
    point.hand_mm_per_s = DVec3(0);
  }
  hand_.along_N += share * change_N;
  hand_.most_N += share * glm::length(change_N);
  point.hip_mm = hip_mm;
}

// F = k dx + d dx', dx from the HIP to the proxy (god-object with a virtual coupling; Zilles, Salisbury 1995). dx' is a
// backward difference, so it needs two ticks of contact. On a moving surface dx' is limited to the relative speed of
// hand and surface: anything faster results from points that another frame has exchanged, and must not be damped.
DVec3 ForceLaw::spring(const Contact& contact, Point& point, double dt_s) const noexcept {
  const DVec3 stretch_mm = contact.proxy * scale_.mm_per_unit - point.hip_mm;
  DVec3 rate_mm_per_s = point.stretch.add(stretch_mm, dt_s);
  if (contact.velocity != DVec3(0)) {
    const double apart_mm_per_s = glm::length(point.hand_mm_per_s - contact.velocity * scale_.mm_per_unit);
    const double size_mm_per_s = glm::length(rate_mm_per_s);
    if (size_mm_per_s > apart_mm_per_s) rate_mm_per_s *= apart_mm_per_s / size_mm_per_s;
  }
  return options_.stiffness_N_per_mm * stretch_mm + options_.damping_N_s_per_mm * rate_mm_per_s;
}

DVec3 ForceLaw::update(const Contact& contact, const Pose& pose, double dt_s) noexcept {
  if (!contact.valid || !isFinite(pose.hip) || !std::isfinite(dt_s)) return fault();
  const bool touching = contact.touching, isGiven = touching && contact.force_N;
  hand_ = {};
  move(point_, pose.hip, touching && !isGiven, 1, dt_s);
  torque_mNm_ = DVec3(0);
  if (!touching) return felt(DVec3(0), DVec3(0), 0, dt_s);
  if (isGiven) {
    if (!isFinite(contact.torque_mNm)) return fault();
    const double wanted_N = glm::length(*contact.force_N);
    const DVec3 felt_N = felt(*contact.force_N, contact.velocity, wanted_N, dt_s);
    torque_mNm_ = (wanted_N > 0 ? std::min(1.0, glm::length(felt_N) / wanted_N) : 1) * contact.torque_mNm;
    return felt_N;
  }
  const DVec3 spring_N = spring(contact, point_, dt_s);
  if (custom_) {
    const DVec3 force_N = custom_.function(custom_.user, contact, pose, dt_s, spring_N);
    return felt(force_N, contact.velocity, glm::length(force_N), dt_s);
  }
  if (!isFinite(spring_N) || !isFinite(contact.normal)) return fault();
  // A surface only pushes. Friction depends on the normal force, so without one the tangential part is dropped, too.
  const bool pushes = glm::dot(spring_N, contact.normal) > 0;
  return felt(pushes ? spring_N : DVec3(0), contact.velocity, glm::length(spring_N), dt_s);
}

DVec3 ForceLaw::update(const Contact& whole, std::span<const PointContact> points, const Pose& pose,
                       double dt_s) noexcept {
  if (!whole.valid || !std::isfinite(dt_s)) return fault();
  hand_ = {};
  DVec3 asked_N(0), sum_N(0), torque_mNm(0);
  for (std::size_t i = 0; i < points.size() && i < toolPoints_.size(); ++i) {
    const PointContact& point = points[i];
    const bool touching = whole.touching && point.contact.touching;
    move(toolPoints_[i], point.hip, touching, point.share, dt_s);
    if (!touching) continue;
    const DVec3 force_N = point.share * spring(point.contact, toolPoints_[i], dt_s);
    asked_N += force_N;
    // NaN propagates into the sum.
    if (glm::dot(force_N, point.contact.normal) <= 0) continue;
    sum_N += force_N;
    torque_mNm += glm::cross(scale_.mm_per_unit * (point.hip - pose.hip), force_N);
  }
  if (!isFinite(sum_N) || !isFinite(torque_mNm) || !isFinite(hand_.along_N)) return fault();
  const double wanted_N = glm::length(sum_N);
  const DVec3 felt_N = felt(sum_N, whole.velocity, glm::length(asked_N), dt_s);
  torque_mNm_ = (wanted_N > 0 ? std::min(1.0, glm::length(felt_N) / wanted_N) : 1) * torque_mNm;
  return felt_N;
}

DVec3 ForceLaw::fault() noexcept {
  reset();
  return DVec3(0);
}

// `velocity`: of the surface, model units per second.
DVec3 ForceLaw::felt(const DVec3& target_N, const DVec3& velocity, double demand_N, double dt_s) noexcept {
  const double wanted_N = glm::length(target_N);
  if (!std::isfinite(wanted_N)) return fault();  // the squares of large numbers overflow, too
  demand_N_ = demand_N;
  const double power_W = glm::dot(target_N, scale_.mm_per_unit * velocity) * 1e-3;  // at the wanted force
  const double share = power_W > options_.maxSurfacePower_W ? options_.maxSurfacePower_W / power_W : 1;
  const double most_N = std::min(share * wanted_N, options_.maxForce_N);
  follow(wanted_N > 0 ? target_N * (most_N / wanted_N) : DVec3(0), dt_s);
  return rise(dt_s);
}

// The one law: what the hand does changes the force at once, and what the surface does changes it slowly, whatever it
// is. While the proxy follows without a jump, the spring changes by the hand's motion along it and by nothing else. Of
// a change of what is asked for, that much is the hand's, and the rest is the surface's. A force that is still there
// where none is asked for falls as the spring of a hand that withdraws, and so gives it no more energy than a spring
// does.
void ForceLaw::follow(const DVec3& target_N, double dt_s) noexcept {
  const double asked_N = glm::length(target_N), last_N = glm::length(followed_N_);
  const double lastAsked_N = std::exchange(asked_N_, asked_N);
  if (!std::exchange(isMoveKnown_, true)) {
    followed_N_ = target_N;
    return;
  }
  if (asked_N == 0 && last_N == 0) return;
  const DVec3 along = asked_N > 0 ? target_N / asked_N : followed_N_ / last_N;
  const double surface_N = inTime(kSurfaceShare * options_.maxRise_N_per_s, dt_s);
  const double hand_N = -glm::dot(hand_.along_N, along);
  const double explained_N = std::clamp(asked_N - lastAsked_N, std::min(hand_N, 0.0), std::max(hand_N, 0.0));
  const double least_N = std::max(0.0, last_N + std::min(hand_N, explained_N) - surface_N);
  const double most_N = std::max(0.0, last_N + explained_N) + surface_N;
  const DVec3 next_N = asked_N < least_N ? least_N * along : asked_N > most_N ? most_N * along : target_N;
  followed_N_ = towards(followed_N_, next_N, hand_.most_N + surface_N);
}

// The step begins at the last force, shrunk to the new size if it was larger: a decrease by the hand is immediate, a
// rotation is not.
DVec3 ForceLaw::rise(double dt_s) noexcept {
  const double last_N = glm::length(force_N_), size_N = glm::length(followed_N_);
  if (last_N > size_N) force_N_ *= size_N / last_N;
  force_N_ = towards(force_N_, followed_N_, inTime(options_.maxRise_N_per_s, dt_s));
  return force_N_;
}

}  // namespace palpate
