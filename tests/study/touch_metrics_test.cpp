// Every metric on a trace with a known answer; an error of two per cent fails.
#include "haptics/study/touch_metrics.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <numbers>

#include "engine/cloud/counter_random.hpp"
#include "haptics/study/truth_path.hpp"
#include "tests/near.hpp"

namespace palpate::test::touch_metrics_test {

namespace {

constexpr double kStiffness = 0.4;
constexpr double kRate_Hz = 1000;
constexpr ModelScale kScale{2};  // one unit is two millimetres

// A slide below a sphere of 50 units, answered by a god-object on a sphere of another size, with a given force.
class Slide {
 public:
  explicit Slide(double speed_mm_per_s = 50) : shape_(makeShape("sphere")), truth_(truthOf(*shape_)) {
    const SurfacePoint start = shape_->closest({50, 1, 2});
    path_ = std::make_unique<TruthPath>(
        truthSlide(truth_, start, DVec3(0, 1, 0.3), kScale, {.speed_mm_per_s = speed_mm_per_s}));
    for (double t_s = 0; t_s < path_->path.duration_s(); t_s += 1 / kRate_Hz) {
      const DVec3 hip = path_->path.at(t_s);
      const DVec3 normal = glm::normalize(hip);
      const bool contact = glm::length(hip) < 50;
      const DVec3 proxy = contact ? 50.0 * normal : hip;
      trace.rows.push_back({.time_s = t_s, .hip = hip, .proxy = proxy, .normal = normal, .contact = contact});
      trace.rows.back().force_N = kStiffness * kScale.mm_per_unit * (proxy - hip);
    }
  }

  // Only the slide itself.
  std::vector<JudgedTick> judged() const {
    const auto all = judgedWhole();
    const auto part = between(all, path_->from_s, path_->to_s);
    return {part.begin(), part.end()};
  }
  std::vector<JudgedTick> judgedWhole() const {
    std::vector<DVec3> hips;
    for (const TraceRow& row : trace.rows) hips.push_back(row.hip);
    return judge(trace, followTruth(hips, truth_, kScale.toUnits(0.05)), truth_);
  }

  const TruthPath& path() const { return *path_; }

  Trace trace;

 private:
  std::unique_ptr<AnalyticShape> shape_;
  TouchTruth truth_;
  std::unique_ptr<TruthPath> path_;
};

DVec3 turned(const DVec3& v, const DVec3& axis, double angle_deg) {
  const double angle = angle_deg * std::numbers::pi / 180;
  return std::cos(angle) * v + std::sin(angle) * glm::cross(axis, v) + (1 - std::cos(angle)) * glm::dot(axis, v) * axis;
}

// Force = K depth along z over a plane, plus a disturbance; depth 1 mm.
std::vector<JudgedTick> steady(std::size_t count, const auto& force_N) {
  std::vector<JudgedTick> ticks(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double t_s = static_cast<double>(i) / kRate_Hz;
    ticks[i].row = {.time_s = t_s, .hip = {0, 0, -0.5}, .force_N = force_N(t_s), .contact = true};
    ticks[i].shouldTouch = true;
    ticks[i].truth = {{0, 0, 0}, {0, 0, 1}};
  }
  return ticks;
}

std::vector<double> tone(double frequency_Hz, double amplitude, std::size_t count, double rate_Hz = 1000) {
  std::vector<double> signal(count);
  for (std::size_t i = 0; i < count; ++i)
    signal[i] = amplitude * std::sin(2 * std::numbers::pi * frequency_Hz * static_cast<double>(i) / rate_Hz + 0.3);
  return signal;
}

}  // namespace

TEST_CASE("a step of the force at an edge of the truth does not count as roughness") {
  const auto cube = makeShape("cube");
  const TouchTruth truth = truthOf(*cube);
  const TruthPath path = truthSlide(truth, cube->closest({38, 7, 60}), DVec3(1, 0, 0), {1}, {});
  std::vector<DVec3> hips;
  for (double t_s = 0; t_s < path.path.duration_s(); t_s += 1 / kRate_Hz) hips.push_back(path.path.at(t_s));
  const auto ideal = followTruth(hips, truth, 0.05, 2);
  for (const IdealTick& tick : ideal)
    if (const double toEdge = 50 - tick.truth.position.x; tick.shouldTouch && std::abs(toEdge - 2) > 0.1)
      CHECK(tick.offEdges == (toEdge > 2));
  for (const IdealTick& tick : followTruth(hips, truth, 0.05)) CHECK(tick.offEdges);
  std::vector<JudgedTick> ticks;
  for (std::size_t i = 0; i < ideal.size(); ++i) {
    const double t_s = static_cast<double>(i) / kRate_Hz;
    const double slow_N = 0.1 * std::sin(2 * std::numbers::pi * 10 * t_s);
    const bool past = ideal[i].truth.position.x > 49;
    ticks.push_back({ideal[i], {.time_s = t_s, .force_N = past ? DVec3(1, 0, 0) : DVec3(0, 0, 1 + slow_N)}});
  }
  const auto slide = between(ticks, path.from_s, path.to_s);
  CHECK(continuity(slide, kRate_Hz).roughShare > 0.5);
  CHECK(continuityOffEdges(slide, kRate_Hz).roughShare < 0.02);
  CHECK(continuityOffEdges(slide, kRate_Hz).power > 0);
}

TEST_CASE("M4: a touch that ends slightly before the truth's is not rough, one that ends long before is") {
  const auto endsAt = [](double off_mm) {  // along x at 50 mm/s; the truth's touch ends at 10 mm
    std::vector<JudgedTick> ticks(300);
    for (std::size_t i = 0; i < ticks.size(); ++i) {
      const double t_s = static_cast<double>(i) / kRate_Hz, x = 50 * t_s;
      ticks[i].row = {.time_s = t_s, .hip = {x, 0, -1}, .force_N = DVec3(0, 0, x < off_mm ? 0.4 + 0.01 * t_s : 0)};
      ticks[i].shouldTouch = x < 10;
    }
    return ticks;
  };
  for (const double off_mm : {9.4, 10.0}) {
    CHECK(continuity(endsAt(off_mm), kRate_Hz, 0.7).max_N_per_s == near(0.01, 1e-6));
    CHECK(continuity(endsAt(off_mm), kRate_Hz, 0.7).power > 0);
  }
  CHECK(continuity(endsAt(9.4), kRate_Hz).max_N_per_s > 100);
  CHECK(continuity(endsAt(9), kRate_Hz, 0.7).max_N_per_s > 100);
}

TEST_CASE("a perfect trace has no error in any metric") {
  const Slide slide;
  const auto ticks = slide.judged();
  CHECK(ticks.size() > 550);
  CHECK(heldShare(ticks) == 1);
  CHECK(angleError(ticks).max_deg < 1e-6);
  CHECK(heightError(ticks, kScale).rms_mm < 1e-9);
  CHECK(forceError(ticks, kStiffness, kScale) < 1e-6);
  CHECK(continuity(ticks, kRate_Hz).roughShare < 0.02);
  CHECK(lagBehind(ticks, kScale).max_mm < 1e-5);
  CHECK(tangentialShare(ticks) < 1e-6);
  CHECK(freeForce_N(slide.judgedWhole(), 0) == 0);
}

TEST_CASE("M1: a force tilted by ten degrees, and one tilted at one tick in ten") {
  Slide slide;
  for (TraceRow& row : slide.trace.rows) row.force_N = turned(row.force_N, frameAround(row.normal).u, 10);
  CHECK(angleError(slide.judged()).mean_deg == near(10, 0.005));
  CHECK(angleError(slide.judged()).p95_deg == near(10, 0.005));
  Slide seldom;
  for (std::size_t i = 0; i < seldom.trace.rows.size(); i += 10) {
    TraceRow& row = seldom.trace.rows[i];
    row.force_N = turned(row.force_N, frameAround(row.normal).u, 30);
  }
  const AngleError error = angleError(seldom.judged());
  CHECK(error.mean_deg == near(3, 0.015));  // the count is not a multiple of ten
  CHECK(error.p95_deg == near(30, 0.005));
  CHECK(error.max_deg == near(30, 0.005));
}

TEST_CASE("M2: a proxy too deep by 0.1 mm, and one that oscillates by 0.2 mm") {
  Slide slide;
  for (TraceRow& row : slide.trace.rows) row.proxy -= kScale.toUnits(0.1) * row.normal;
  CHECK(heightError(slide.judged(), kScale).bias_mm == near(-0.1, 0.005));
  CHECK(heightError(slide.judged(), kScale).rms_mm == near(0.1, 0.005));
  Slide wavering;
  for (std::size_t i = 0; i < wavering.trace.rows.size(); ++i)
    wavering.trace.rows[i].proxy += kScale.toUnits(i % 2 ? 0.2 : -0.2) * wavering.trace.rows[i].normal;
  CHECK(std::abs(heightError(wavering.judged(), kScale).bias_mm) < 0.001);
  CHECK(heightError(wavering.judged(), kScale).rms_mm == near(0.2, 0.005));
}

TEST_CASE("M3: a force too small by a tenth, and one missing at one tick in four") {
  Slide slide;
  for (TraceRow& row : slide.trace.rows) row.force_N *= 0.9;
  CHECK(forceError(slide.judged(), kStiffness, kScale) == near(0.1, 0.005));
  Slide missing;
  for (std::size_t i = 0; i < missing.trace.rows.size(); i += 4) missing.trace.rows[i].force_N = DVec3(0);
  CHECK(forceError(missing.judged(), kStiffness, kScale) == near(0.5, 0.005));
  CHECK(heldShare(missing.judged()) == near(0.75, 0.005));
}

TEST_CASE("M4: the slope of a slow wave, and the share of a fast one") {
  const double turn = 2 * std::numbers::pi;
  const auto slow = steady(4000, [&](double t) { return DVec3(0, 0, 1 + 0.1 * std::sin(turn * 5 * t)); });
  CHECK(continuity(slow, kRate_Hz).max_N_per_s == near(0.1 * turn * 5, 0.005));
  CHECK(continuity(slow, kRate_Hz).roughShare < 0.001);
  const auto jump = steady(4000, [&](double t) { return DVec3(0, t < 2 ? 0.0 : 0.3, 1); });
  CHECK(continuity(jump, kRate_Hz).max_N_per_s == near(300, 0.005));
  CHECK(continuity(jump, kRate_Hz).p99_N_per_s == 0);
  CHECK(continuity(jump, kRate_Hz).power == near(90'000, 0.005));
  // dF/dt of 20 Hz at 3 and of 160 Hz at 1 N/s: a tenth of the power is rough.
  const auto both = steady(4000, [&](double t) {
    return DVec3(std::cos(turn * 20 * t) * 3 / (turn * 20), std::cos(turn * 160 * t) / (turn * 160), 1);
  });
  CHECK(continuity(both, kRate_Hz).roughShare == near(0.1, 0.08));
}

TEST_CASE("M5: a push has broken through if it touches nothing, or from behind") {
  Trace push;
  push.rows.push_back({.proxy = {0, 0, 1}, .contact = true});
  CHECK_FALSE(cameThrough(push, DVec3(0), {0, 0, 1}));
  push.rows.push_back({.proxy = {0, 0, -1}, .contact = true});
  CHECK(cameThrough(push, DVec3(0), {0, 0, 1}));
  CHECK_FALSE(cameThrough(push, DVec3(0), {0, 0, -1}));
  push.rows.push_back({.proxy = {0, 0, 1}, .contact = false});
  CHECK(cameThrough(push, DVec3(0), {0, 0, 1}));
}

TEST_CASE("M6: a proxy that is where the god-object was four ticks ago") {
  const Slide perfect;
  Slide late;
  for (std::size_t i = 4; i < late.trace.rows.size(); ++i)
    if (perfect.trace.rows[i - 4].contact) late.trace.rows[i].proxy = perfect.trace.rows[i - 4].proxy;
  const auto whole = late.judgedWhole();
  const auto ticks = between(whole, late.path().from_s + 0.01, late.path().to_s);
  const Lag lag = lagBehind(ticks, kScale);
  CHECK(lag.delay_ms == near(4, 0.005));
  CHECK(lag.mean_mm == near(4 * 0.05 / (1 - 0.5 / 50) * (1 - 0.5 / 50), 0.02));
  CHECK(lag.max_mm == near(0.2, 0.02));
}

TEST_CASE("M7: late ticks") {
  auto ticks = steady(1000, [](double) { return DVec3(0, 0, 1); });
  for (std::size_t i = 0; i < 30; ++i) ticks[i * 7].row.step_us = 1200;
  CHECK(lateShare(ticks, 1000) == near(0.03, 0.005));
}

TEST_CASE("M8: a force in the air counts, one near the surface does not") {
  Slide slide;
  for (TraceRow& row : slide.trace.rows)
    if (!row.contact) row.force_N = DVec3(0, 0, glm::length(row.hip) > 52 ? 0.25 : 3.0);
  CHECK(freeForce_N(slide.judgedWhole(), 2) == near(0.25, 0.005));
  CHECK_FALSE(freeForce_N(slide.judgedWhole(), 100));
}

TEST_CASE("M10: a force with drag, and a proxy that drifts while the HIP rests") {
  Slide slide;
  for (TraceRow& row : slide.trace.rows) row.force_N += 0.3 * glm::length(row.force_N) * frameAround(row.normal).v;
  CHECK(tangentialShare(slide.judged()) == near(0.3, 0.005));
  auto resting = steady(100, [](double) { return DVec3(0, 0, 1); });
  for (std::size_t i = 0; i < resting.size(); ++i) resting[i].row.proxy.x = 0.002 * static_cast<double>(i);
  CHECK(drift_mm(resting, kScale) == near(0.396, 0.005));
}

TEST_CASE("M11: the force settles seven ticks after the edit; its largest step is found") {
  Trace after, fresh;
  for (int i = 0; i < 50; ++i) {
    const double wrong_N = i < 17 ? 0.02 : 0.0005;
    after.rows.push_back({.force_N = {0, 0, 1 + wrong_N}, .contact = i > 0});
    fresh.rows.push_back({.force_N = {0, 0, 1}, .contact = true});
  }
  CHECK(ticksUntilEqual(after, fresh, 10, 1e-3) == 7);
  CHECK(ticksUntilEqual(after, fresh, 20, 1e-3) == 0);
  CHECK_FALSE(ticksUntilEqual(after, fresh, 10, 1e-4));
  CHECK_FALSE(ticksUntilEqual(after, fresh, 50, 1));
  CHECK(largestForceStep_N(after) == near(0.0195, 0.005));
}

TEST_CASE("M12: traces that agree, and the difference of those that do not") {
  const Slide a, b;
  CHECK(identical(a.trace, b.trace));
  CHECK(forceDifference_N(a.trace, b.trace) == 0);
  Slide other;
  other.trace.rows[300].force_N.y += 0.05;
  CHECK_FALSE(identical(a.trace, other.trace));
  CHECK(forceDifference_N(a.trace, other.trace) == near(0.05, 0.005));
  other.trace.rows[300].force_N.y = std::numeric_limits<double>::quiet_NaN();
  CHECK(std::isinf(forceDifference_N(a.trace, other.trace)));
  other.trace.rows.pop_back();
  CHECK(std::isinf(forceDifference_N(a.trace, other.trace)));
}

TEST_CASE("metrics of no ticks are defined and contain no invalid number") {
  const JudgedTicks none;
  CHECK(heldShare(none) == 1);
  CHECK(angleError(none).count == 0);
  CHECK(heightError(none, kScale).count == 0);
  CHECK(forceError(none, kStiffness, kScale) == 0);
  CHECK(continuity(none, kRate_Hz).max_N_per_s == 0);
  CHECK(lagBehind(none, kScale).delay_ms == 0);
  CHECK(lateShare(none, 1000) == 0);
  CHECK_FALSE(freeForce_N(none, 0));
  CHECK(tangentialShare(none) == 0);
  CHECK(drift_mm(none, kScale) == 0);
  CHECK(cameThrough({}, DVec3(0), DVec3(0, 0, 1)) == false);
}

TEST_CASE("a tone has its power at its frequency") {
  for (const std::size_t count : {256u, 1000u, 5000u}) {
    const auto power = welchPower(tone(125, 1, count));
    REQUIRE(power.size() == 129);
    CHECK(std::ranges::max_element(power) - power.begin() == 32);
    CHECK(power[28] < 1e-3 * power[32]);
  }
}

TEST_CASE("two tones share the power as the squares of their amplitudes, across components and lengths") {
  for (const std::size_t count : {200u, 600u, 4000u}) {
    const auto low = tone(20, 2, count), high = tone(200, 1, count);
    std::vector<DVec3> signal(count);
    for (std::size_t i = 0; i < count; ++i) signal[i] = {low[i], 0, high[i]};
    CHECK(powerShare(signal, 1000, 50, 500) == near(0.2, 0.02));
    CHECK(powerShare(signal, 1000, 0, 50) == near(0.8, 0.02));
    CHECK(powerShare(signal, 2000, 300, 500) == near(0.2, 0.02));  // 400 Hz at that rate
  }
}

TEST_CASE("white noise has the same power at all frequencies") {
  std::vector<DVec3> noise(40'000);
  for (std::size_t i = 0; i < noise.size(); ++i) noise[i] = randomNormal3(9, i);
  CHECK(powerShare(noise, 1000, 50, 500) == near(0.9, 0.01));
  CHECK(powerShare(noise, 1000, 100, 200) == near(0.2, 0.05));
}

TEST_CASE("a constant has no power at any frequency, and no signal has no power") {
  const std::vector<DVec3> constant(300, DVec3(1, 2, 3));
  CHECK(powerShare(constant, 1000, 50, 500) < 1e-6);
  CHECK(powerShare(std::vector<DVec3>(300, DVec3(0)), 1000, 0, 500) == 0);
  CHECK(powerShare({}, 1000, 0, 500) == 0);
  CHECK(welchPower(std::vector<double>{1}).empty());
}

}  // namespace palpate::test::touch_metrics_test
