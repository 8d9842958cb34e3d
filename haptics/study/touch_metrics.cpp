#include "haptics/study/touch_metrics.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "engine/core/check.hpp"

namespace palpate {

namespace {

// In place, decimation in time; the size is a power of two (Cooley and Tukey 1965).
void fourierTransform(std::vector<std::complex<double>>& values) {
  const std::size_t size = values.size();
  for (std::size_t i = 1, reversed = 0; i < size; ++i) {
    std::size_t bit = size >> 1;
    for (; reversed & bit; bit >>= 1) reversed ^= bit;
    reversed ^= bit;
    if (i < reversed) std::swap(values[i], values[reversed]);
  }
  for (std::size_t span = 2; span <= size; span *= 2)
    for (std::size_t k = 0; k < span / 2; ++k) {
      const auto turn = std::polar(1.0, -2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(span));
      for (std::size_t begin = k; begin < size; begin += span) {
        const auto odd = turn * values[begin + span / 2];
        values[begin + span / 2] = values[begin] - odd;
        values[begin] += odd;
      }
    }
}

constexpr double kRoughFrom_Hz = 50, kRoughTo_Hz = 500;  // where Pacinian corpuscles respond (Bolanowski et al. 1988)

bool hasForce(const JudgedTick& tick) { return tick.row.force_N != DVec3(0); }
bool felt(const JudgedTick& tick) { return tick.shouldTouch && hasForce(tick); }

double quantile(std::vector<double> samples, double q) {
  std::ranges::sort(samples);
  return quantileOfSorted(samples, q);
}

bool smoothAround(const SurfacePoint& place, const TouchTruth& truth, double reach) {
  constexpr int kDirections = 8;
  constexpr double kSmoothCosine = 0.9;
  constexpr double kDepth = 0.02;  // of the reach: past an edge, its other side is nearest to a point just below
  const Frame3 frame = frameAround(place.normal);
  for (int k = 0; k < kDirections; ++k) {
    const double turn = 2 * std::numbers::pi * k / kDirections;
    const DVec3 aside = std::cos(turn) * frame.u + std::sin(turn) * frame.v;
    const SurfacePoint near = truth.closest(place.position + reach * (aside - kDepth * place.normal));
    if (glm::dot(near.normal, place.normal) < kSmoothCosine) return false;
  }
  return true;
}

DVec3 alongSurface(const DVec3& v, const DVec3& normal) { return v - glm::dot(v, normal) * normal; }

}  // namespace

std::vector<double> welchPower(std::span<const double> signal, std::size_t segment) {
  segment = std::min(segment, signal.size());
  if (segment < 2) return {};
  const std::size_t size = std::bit_ceil(segment);  // zero-padded, which only adds frequencies in between
  std::vector<double> power(size / 2 + 1, 0.0);
  std::vector<std::complex<double>> values(size);
  for (std::size_t begin = 0; begin + segment <= signal.size(); begin += (segment + 1) / 2) {
    std::ranges::fill(values, 0.0);
    for (std::size_t i = 0; i < segment; ++i) {
      const double phase = 2 * std::numbers::pi * (static_cast<double>(i) + 0.5) / static_cast<double>(segment);
      values[i] = signal[begin + i] * 0.5 * (1 - std::cos(phase));
    }
    fourierTransform(values);
    // The frequencies between zero and half the rate represent their mirror images, too.
    for (std::size_t k = 0; k < power.size(); ++k) power[k] += (k == 0 || k == size / 2 ? 1 : 2) * std::norm(values[k]);
  }
  return power;
}

double powerShare(std::span<const DVec3> signal, double rate_Hz, double from_Hz, double to_Hz) {
  double all = 0, between = 0;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> component(signal.size());
    std::ranges::transform(signal, component.begin(), [&](const DVec3& v) { return v[axis]; });
    const auto power = welchPower(component);
    for (std::size_t k = 0; k < power.size(); ++k) {
      const double frequency_Hz = rate_Hz * static_cast<double>(k) / (2 * static_cast<double>(power.size() - 1));
      all += power[k];
      if (frequency_Hz >= from_Hz && frequency_Hz <= to_Hz) between += power[k];
    }
  }
  return all > 0 ? between / all : 0;
}

std::vector<IdealTick> followTruth(std::span<const DVec3> hips, const TouchTruth& truth, double longestStep,
                                   double edgeReach) {
  GodObject ideal(truth, longestStep);
  std::vector<IdealTick> ticks;
  ticks.reserve(hips.size());
  for (const DVec3& hip : hips) {
    ideal.follow(hip);
    ticks.push_back({.shouldTouch = ideal.touching(),
                     .offEdges = edgeReach <= 0 || !ideal.touching() || smoothAround(ideal.contact(), truth, edgeReach),
                     .truth = ideal.contact(),
                     .hipHeight = ideal.touching() ? 0 : truth.signedDistance(hip)});
  }
  return ticks;
}

std::vector<JudgedTick> judge(const Trace& trace, std::span<const IdealTick> ideal, const TouchTruth& truth) {
  PALPATE_CHECK_EQ(trace.rows.size(), ideal.size());
  std::vector<JudgedTick> ticks;
  ticks.reserve(ideal.size());
  for (std::size_t i = 0; i < ideal.size(); ++i) {
    const TraceRow& row = trace.rows[i];
    ticks.push_back({ideal[i], row, row.contact ? truth.signedDistance(row.proxy) : 0});
  }
  return ticks;
}

JudgedTicks between(JudgedTicks ticks, double from_s, double to_s) {
  const auto first = std::ranges::lower_bound(ticks, from_s, {}, [](const JudgedTick& t) { return t.row.time_s; });
  const auto last = std::ranges::lower_bound(ticks, to_s, {}, [](const JudgedTick& t) { return t.row.time_s; });
  return first < last ? JudgedTicks(first, last) : JudgedTicks();
}

double heldShare(JudgedTicks ticks) {
  const auto wanted = std::ranges::count_if(ticks, &JudgedTick::shouldTouch);
  const auto held = std::ranges::count_if(ticks, felt);
  return wanted ? static_cast<double>(held) / static_cast<double>(wanted) : 1;
}

AngleError angleError(JudgedTicks ticks) {
  std::vector<double> angles;
  double sum = 0;
  for (const JudgedTick& tick : ticks) {
    if (!felt(tick)) continue;
    angles.push_back(angleBetween_deg(tick.row.force_N, tick.truth.normal));
    sum += angles.back();
  }
  if (angles.empty()) return {};
  std::ranges::sort(angles);
  return {.count = angles.size(),
          .mean_deg = sum / static_cast<double>(angles.size()),
          .p95_deg = quantileOfSorted(angles, 0.95),
          .max_deg = angles.back()};
}

HeightError heightError(JudgedTicks ticks, const ModelScale& scale) {
  double sum = 0, squares = 0;
  HeightError error;
  for (const JudgedTick& tick : ticks) {
    if (!tick.row.contact || !tick.shouldTouch) continue;
    const double height_mm = scale.toMm(tick.proxyHeight);
    ++error.count;
    sum += height_mm;
    squares += height_mm * height_mm;
  }
  if (error.count == 0) return error;
  error.bias_mm = sum / static_cast<double>(error.count);
  error.rms_mm = std::sqrt(squares / static_cast<double>(error.count));
  return error;
}

double forceError(JudgedTicks ticks, double stiffness_N_per_mm, const ModelScale& scale) {
  double missed = 0, wanted = 0;
  for (const JudgedTick& tick : ticks) {
    if (!tick.shouldTouch) continue;
    const double true_N = stiffness_N_per_mm * scale.toMm(glm::distance(tick.row.hip, tick.truth.position));
    const double off_N = glm::length(tick.row.force_N) - true_N;
    missed += off_N * off_N;
    wanted += true_N * true_N;
  }
  return wanted > 0 ? std::sqrt(missed / wanted) : 0;
}

namespace {

/// Whether each tick touches, and the god-object still does when the HIP has moved `letGo` further.
std::vector<bool> goesOn(JudgedTicks ticks, double letGo) {
  std::vector<bool> on(ticks.size());
  const DVec3* freed = nullptr;  // first free HIP after the tick
  for (std::size_t i = ticks.size(); i-- > 0;) {
    const JudgedTick& tick = ticks[i];
    if (!tick.shouldTouch) freed = &tick.row.hip;
    on[i] = tick.shouldTouch && !(freed && glm::distance(*freed, tick.row.hip) < letGo);
  }
  return on;
}

template <class Counts>
Continuity continuityWhere(JudgedTicks ticks, double rate_Hz, Counts&& counts) {
  std::vector<DVec3> rates;
  std::vector<double> sizes;
  double power = 0;
  for (std::size_t i = 1; i < ticks.size(); ++i) {
    if (!counts(i - 1) || !counts(i)) continue;
    rates.push_back((ticks[i].row.force_N - ticks[i - 1].row.force_N) * rate_Hz);
    sizes.push_back(glm::length(rates.back()));
    power += sizes.back() * sizes.back();
  }
  if (sizes.empty()) return {};
  constexpr double kRounding_N_per_s = 1e-6;  // rounding: on a flat surface nothing else remains, and it is meaningless
  const double max_N_per_s = std::ranges::max(sizes);
  return {.p99_N_per_s = quantile(sizes, 0.99),
          .max_N_per_s = max_N_per_s,
          .power = power,
          .roughShare = max_N_per_s > kRounding_N_per_s ? powerShare(rates, rate_Hz, kRoughFrom_Hz, kRoughTo_Hz) : 0};
}

}  // namespace

Continuity continuity(JudgedTicks ticks, double rate_Hz, double letGo) {
  const std::vector<bool> on = goesOn(ticks, letGo);
  return continuityWhere(ticks, rate_Hz, [&](std::size_t i) { return on[i]; });
}

Continuity continuityOffEdges(JudgedTicks ticks, double rate_Hz) {
  return continuityWhere(ticks, rate_Hz, [&](std::size_t i) { return ticks[i].shouldTouch && ticks[i].offEdges; });
}

bool cameThrough(const Trace& push, const DVec3& middle, const DVec3& outward) {
  if (push.rows.empty()) return false;
  const TraceRow& last = push.rows.back();
  return !last.contact || glm::dot(last.proxy - middle, outward) < 0;
}

Lag lagBehind(JudgedTicks ticks, const ModelScale& scale) {
  Lag lag;
  double sum_mm = 0, behind = 0, travelled = 0;
  for (std::size_t i = 1; i < ticks.size(); ++i) {
    const JudgedTick& tick = ticks[i];
    if (!ticks[i - 1].shouldTouch || !tick.shouldTouch || !tick.row.contact) continue;
    const DVec3 gap = alongSurface(tick.truth.position - tick.row.proxy, tick.truth.normal);
    const DVec3 velocity =
        (tick.truth.position - ticks[i - 1].truth.position) / (tick.row.time_s - ticks[i - 1].row.time_s);
    const double gap_mm = scale.toMm(glm::length(gap));
    ++lag.count;
    sum_mm += gap_mm;
    lag.max_mm = std::max(lag.max_mm, gap_mm);
    behind += glm::dot(gap, velocity);
    travelled += glm::dot(velocity, velocity);
  }
  if (lag.count) lag.mean_mm = sum_mm / static_cast<double>(lag.count);
  if (travelled > 0) lag.delay_ms = 1e3 * behind / travelled;
  return lag;
}

double lateShare(JudgedTicks ticks, double period_us) {
  if (ticks.empty()) return 0;
  const auto late = std::ranges::count_if(ticks, [&](const JudgedTick& tick) { return tick.row.step_us > period_us; });
  return static_cast<double>(late) / static_cast<double>(ticks.size());
}

std::optional<double> freeForce_N(JudgedTicks ticks, double margin) {
  std::optional<double> largest;
  for (const JudgedTick& tick : ticks)
    if (!tick.shouldTouch && tick.hipHeight > margin)
      largest = std::max(largest.value_or(0), glm::length(tick.row.force_N));
  return largest;
}

double tangentialShare(JudgedTicks ticks) {
  std::vector<double> shares;
  for (const JudgedTick& tick : ticks) {
    if (!felt(tick)) continue;
    const double along_N = glm::length(alongSurface(tick.row.force_N, tick.truth.normal));
    shares.push_back(along_N / std::abs(glm::dot(tick.row.force_N, tick.truth.normal)));
  }
  return quantile(std::move(shares), 0.5);
}

double drift_mm(JudgedTicks ticks, const ModelScale& scale) {
  double farthest = 0;
  for (const JudgedTick& tick : ticks)
    farthest = std::max(farthest, glm::distance(tick.row.proxy, ticks.front().row.proxy));
  return scale.toMm(farthest);
}

std::optional<std::size_t> ticksUntilEqual(const Trace& after, const Trace& fresh, std::size_t from,
                                           double tolerance_N) {
  const std::size_t size = std::min(after.rows.size(), fresh.rows.size());
  if (from >= size) return std::nullopt;
  std::size_t equalFrom = size;
  while (equalFrom > from &&
         glm::distance(after.rows[equalFrom - 1].force_N, fresh.rows[equalFrom - 1].force_N) <= tolerance_N)
    --equalFrom;
  if (equalFrom == size) return std::nullopt;
  return equalFrom - from;
}

double largestForceStep_N(const Trace& trace) {
  double largest = 0;
  for (std::size_t i = 1; i < trace.rows.size(); ++i)
    if (trace.rows[i - 1].contact && trace.rows[i].contact)
      largest = std::max(largest, glm::distance(trace.rows[i - 1].force_N, trace.rows[i].force_N));
  return largest;
}

double forceDifference_N(const Trace& a, const Trace& b) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  if (a.rows.size() != b.rows.size()) return kInfinite;
  double largest = 0;
  for (std::size_t i = 0; i < a.rows.size(); ++i) {
    const double difference = glm::distance(a.rows[i].force_N, b.rows[i].force_N);
    if (!std::isfinite(difference)) return kInfinite;
    largest = std::max(largest, difference);
  }
  return largest;
}

bool identical(const Trace& a, const Trace& b) {
  const auto same = [](const TraceRow& x, const TraceRow& y) {
    return x.time_s == y.time_s && x.hip == y.hip && x.proxy == y.proxy && x.normal == y.normal &&
           x.force_N == y.force_N && x.torque_mNm == y.torque_mNm && x.contact == y.contact && x.valid == y.valid &&
           x.neighbours == y.neighbours;
  };
  return std::ranges::equal(a.rows, b.rows, same);
}

}  // namespace palpate
