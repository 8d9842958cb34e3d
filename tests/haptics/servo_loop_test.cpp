#include "haptics/servo_loop.hpp"

#include <doctest/doctest.h>
#include <unistd.h>

#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <thread>

#include "engine/core/clock.hpp"
#include "engine/core/error.hpp"
#include "engine/core/thread_priority.hpp"
#include "haptics/devices/path_device.hpp"
#include "tests/haptics/contact_doubles.hpp"
#include "tests/haptics/troubled_hands.hpp"
#include "tests/near.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate::servo_loop_test {
namespace {

/// Onto the sphere's pole, along its surface 1 unit deep, and out again.
Path touchAndGo() {
  return Path({{0, {0, 0, 53}}, {0.1, {0, 0, 49}}, {0.3, {5, 3, 48.7}}, {0.4, {5, 3, 49.3}}, {0.5, {5, 3, 53}}});
}

const ForceOptions kSpringOnly{.damping_N_s_per_mm = 0, .maxRise_N_per_s = std::numeric_limits<double>::infinity()};

ServoOptions lasting(double duration_s, bool realtime = false) {
  return {.duration_s = duration_s, .realtime = realtime};
}

constexpr const char* kFault = "faulty: the cable is out; put it back";

ServoResult playedOn(SphereContact& sphere, HapticDevice& device, const ServoOptions& options,
                     const ForceOptions& force = {}) {
  return ServoLoop(device, sphere, ForceLaw(force, {}), options).run();
}
ServoResult played(HapticDevice& device, const ServoOptions& options, const ForceOptions& force = {}) {
  SphereContact sphere(kRadius);
  return playedOn(sphere, device, options, force);
}

}  // namespace

TEST_CASE("on a sphere the force is zero outside and stiffness times depth along the normal inside") {
  PathDevice device(touchAndGo());
  SphereContact sphere(kRadius);
  const ModelScale scale{1.5};
  ServoLoop loop(device, sphere, ForceLaw(kSpringOnly, scale), lasting(0.5));
  const ServoResult result = loop.run();
  CHECK_FALSE(result.deviceFailed);
  CHECK(result.fault.empty());
  REQUIRE(result.trace().rows.size() == 500);
  std::size_t touching = 0;
  for (std::size_t i = 0; i < 500; ++i) {
    const TraceRow& row = result.trace().rows[i];
    CHECK(row.time_s == static_cast<double>(i) / 1000);
    CHECK(row.hip == device.path().at(row.time_s));
    CHECK(row.valid);
    const double depth_mm = scale.toMm(kRadius - glm::length(row.hip));
    if (depth_mm <= 0) {
      CHECK(row.force_N == DVec3(0));
      CHECK(row.penetration_mm == 0);
      CHECK_FALSE(row.contact);
      continue;
    }
    ++touching;
    CHECK(row.contact);
    CHECK(row.penetration_mm == near(depth_mm, 1e-6));
    CHECK(glm::length(row.force_N) == near(0.8 * depth_mm, 1e-6));
    CHECK(glm::dot(row.force_N, row.normal) == near(glm::length(row.force_N), 1e-6));
    CHECK(glm::dot(row.normal, glm::normalize(row.hip)) == near(1, 1e-6));
  }
  CHECK(touching > 200);
  CHECK(result.step_us.count() == 500);
  CHECK(result.late_us.count() == 0);
  CHECK(device.lastForce_N() == DVec3(0));
  CHECK(sphere.largestBudget_us == 0);  // virtual time waits for the answer
}

TEST_CASE("two runs in virtual time give the same bytes") {
  std::string first;
  for (int run = 0; run < 2; ++run) {
    PathDevice device(touchAndGo());
    SphereContact sphere(kRadius);
    ServoLoop loop(device, sphere, ForceLaw({}, {}), lasting(0.5));
    if (run == 0) first = csvOf(loop.run().trace());
    CHECK(csvOf(loop.run().trace()) == first);  // also the second run of one loop
  }
}

TEST_CASE("the forces are the same bit by bit whenever the session begins") {
  const auto begun = [](double begin_s) {  // plays from the first tick on
    const Path path = touchAndGo();
    ScriptedDevice device(
        [&](double time_s) -> DeviceState {
          return {.position = path.at(std::round((time_s - begin_s) * 1000) / 1000), .ok = true};
        },
        {.peakForce_N = 1});
    return played(device, {.duration_s = 0.5, .begin_s = begin_s});
  };
  const ServoResult first = begun(0), later = begun(12.345);
  REQUIRE(first.trace().rows.size() == 500);
  REQUIRE(later.trace().rows.size() == 500);
  for (std::size_t i = 0; i < 500; ++i) CHECK(first.trace().rows[i].force_N == later.trace().rows[i].force_N);
}

TEST_CASE("the workspace map positions the device in the model") {
  PathDevice device(touchAndGo());
  const DVec3 center(1e6, 0, 5);
  SphereContact sphere(2 * kRadius, center);
  ServoLoop loop(device, sphere, ForceLaw(kSpringOnly, {}), lasting(0.2), {.map = {.scale = 2, .offset = center}});
  const Trace trace = loop.run().trace();
  CHECK(trace.rows[0].hip == center + DVec3(0, 0, 106));
  CHECK(trace.rows[100].penetration_mm == near(2, 1e-6));
}

TEST_CASE("the device's peak force is never exceeded") {
  TroubledDevice device(Path({{0, {0, 0, 51}}, {0.6, {0, 0, 51}}, {0.7, {0, 0, 30}}}), {.peakForce_N = 1});
  const Trace trace = played(device, lasting(0.8), kSpringOnly).trace();
  for (const TraceRow& row : trace.rows) CHECK(glm::length(row.force_N) <= 1 + 1e-12);
  CHECK(glm::length(trace.rows[690].force_N) == near(1, 1e-6));
}

TEST_CASE("a device fault ends the session with zero force from that tick on and with its reason") {
  TroubledDevice device(touchAndGo(), {.peakForce_N = 1});
  device.text = kFault;
  SUBCASE("reading") { device.failsReadAt_s = 0.2; }
  SUBCASE("writing") { device.failsWriteAt_s = 0.2; }
  SUBCASE("a position that is not a number") { device.losesPositionAt_s = 0.2; }
  const ServoResult result = played(device, lasting(0.5));
  CHECK(result.deviceFailed);
  CHECK(result.fault == kFault);
  REQUIRE(result.trace().rows.size() == 201);
  CHECK(glm::length(result.trace().rows[199].force_N) > 0.3);  // still ramping up
  CHECK(result.trace().rows[200].force_N == DVec3(0));
  CHECK_FALSE(result.trace().rows[200].valid);
  CHECK(glm::distance(result.trace().rows[200].hip, result.trace().rows[199].hip) < 0.1);
  CHECK(device.last_N == DVec3(0));
  CHECK(summarize(result.trace()).faultTicks == 1);
}

TEST_CASE("a device that fails without a reason is still named") {
  TroubledDevice device(touchAndGo(), {.peakForce_N = 1}, "faulty");
  device.failsReadAt_s = 0;
  const ServoResult result = played(device, lasting(0.5));
  CHECK(result.fault == "faulty: the device failed without saying why");
  CHECK(result.trace().rows.size() == 1);
  CHECK(device.last_N == DVec3(0));
}

TEST_CASE("a query fault gives zero force at its ticks, and the session continues") {
  PathDevice device(touchAndGo());
  SphereContact sphere(kRadius);
  bool withNaN = false;
  double until_s = 0.25;
  SUBCASE("not valid") {}
  SUBCASE("not a number") { withNaN = true; }
  SUBCASE("to the end") { until_s = 1; }
  sphere.failBetween(0.2, until_s, withNaN);
  const ServoResult result = playedOn(sphere, device, lasting(0.3));
  CHECK_FALSE(result.deviceFailed);
  REQUIRE(result.trace().rows.size() == 300);
  for (const TraceRow& row : result.trace().rows) {
    const bool faulty = row.time_s >= 0.2 && row.time_s < until_s;
    CHECK(row.valid == !faulty);
    CHECK(isFinite(row.proxy));
    if (faulty) CHECK(row.force_N == DVec3(0));
  }
  CHECK(glm::length(result.trace().rows[199].force_N) > 0.5);
  // The surface's force returns slowly.
  CHECK((glm::length(result.trace().rows[299].force_N) > 0.05) == (until_s < 0.3));
  CHECK(glm::length(result.trace().rows[299].force_N) < 0.15);
  CHECK(result.counts().withheld.errors == 1);
  CHECK(device.lastForce_N() == DVec3(0));
}

TEST_CASE("the observer sees every tick in virtual time, and an exception from it leaves zero force") {
  PathDevice device(touchAndGo());
  SphereContact sphere(kRadius);
  ServoLoop loop(device, sphere, ForceLaw({}, {}), lasting(0.2));
  std::size_t seen = 0;
  loop.run([&](const TraceRow& row) {
    CHECK(device.lastForce_N() == row.force_N);
    ++seen;
  });
  CHECK(seen == 200);
  const auto impatient = [](const TraceRow& row) {
    if (row.contact) throw std::runtime_error("enough");
  };
  CHECK_THROWS_AS(loop.run(impatient), std::runtime_error);
  CHECK(device.lastForce_N() == DVec3(0));
}

TEST_CASE("a session can be stopped from outside") {
  PathDevice device(touchAndGo());
  SphereContact sphere(kRadius);
  std::atomic<bool> stop = false;
  ServoLoop loop(device, sphere, ForceLaw({}, {}), {.duration_s = 0.5, .stop = &stop});
  const ServoResult result = loop.run([&](const TraceRow& row) { stop = row.time_s >= 0.1; });
  CHECK(result.trace().rows.size() == 101);
  CHECK(device.lastForce_N() == DVec3(0));
}

TEST_CASE("real time follows the wall clock, gives the query a budget, and restores the scheduler") {
  const int policyBefore = ::sched_getscheduler(0);
  PathDevice device(touchAndGo());
  SphereContact sphere(kRadius);
  ServoLoop loop(device, sphere, ForceLaw({}, {}), lasting(0.5, true));
  const Stopwatch watch;
  bool observed = false;
  const ServoResult result = loop.run([&](const TraceRow&) { observed = true; });
  CHECK(watch.elapsed_s() > 0.49);
  CHECK_FALSE(observed);
  CHECK_FALSE(result.trace().virtualTime);
  const std::size_t ticks = result.trace().rows.size();
  REQUIRE(ticks > 0);
  CHECK(ticks + result.trace().missedTicks == 500);  // tick_pacer_test.cpp checks how many a busy machine misses
  for (std::size_t i = 1; i < ticks; ++i) CHECK(result.trace().rows[i].time_s > result.trace().rows[i - 1].time_s);
  CHECK(sphere.smallestBudget_us >= 20);
  CHECK(sphere.largestBudget_us <= 1000 - 200 + 1);
  CHECK(device.lastForce_N() == DVec3(0));
  CHECK(::sched_getscheduler(0) == policyBefore);
}

TEST_CASE("real time runs up to 10 kHz, counts every tick and leaves at most 80 of 100 us to the query") {
  PathDevice device(touchAndGo());
  SphereContact sphere(kRadius);
  const ServoResult result = playedOn(sphere, device, {.rate_Hz = 10'000, .duration_s = 0.3, .realtime = true});
  const std::size_t ticks = result.trace().rows.size();
  CHECK(ticks + result.trace().missedTicks == 3000);
  CHECK(ticks > 0);
  CHECK(result.step_us.count() == ticks);
  CHECK(result.late_us.count() == ticks);
  CHECK(sphere.smallestBudget_us >= 20);
  CHECK(sphere.largestBudget_us <= 80 + 1);
}

TEST_CASE("a session in real time has deadlines while it runs, one on a clock of its own has none") {
  struct Watcher final : TickRecorder {
    void ticked(const TraceRow&, const DeviceState&) noexcept override { ++(HasDeadlines::any() ? urgent : other); }
    int urgent = 0, other = 0;
  };
  SphereContact sphere(kRadius);
  SteppedClock stepped;
  for (SteppedClock* clock : {static_cast<SteppedClock*>(nullptr), &stepped}) {
    PathDevice device(touchAndGo());
    Watcher watcher;
    playedOn(sphere, device, {.duration_s = 0.02, .realtime = true, .clock = clock, .recorder = &watcher});
    CHECK((watcher.urgent > 0) == (clock == nullptr));
    CHECK((watcher.other > 0) == (clock != nullptr));
    CHECK_FALSE(HasDeadlines::any());
  }
}

TEST_CASE("on a clock that stands still during ticks no tick is late, and a query has unlimited time") {
  PathDevice device(touchAndGo()), again(touchAndGo());
  SphereContact sphere(kRadius);
  SteppedClock clock;
  const ServoResult result = playedOn(sphere, device, {.duration_s = 0.5, .realtime = true, .clock = &clock});
  CHECK(result.trace().missedTicks == 0);
  CHECK(result.late_us.max_us() == 0);
  CHECK(sphere.largestBudget_us == 0);
  const Trace expected = played(again, lasting(0.5)).trace();
  REQUIRE(result.trace().rows.size() == expected.rows.size());
  for (std::size_t i = 0; i < expected.rows.size(); ++i) {
    CHECK(result.trace().rows[i].time_s == expected.rows[i].time_s);
    CHECK(result.trace().rows[i].force_N == expected.rows[i].force_N);
  }
}

TEST_CASE("a held clock lets another thread pace the session, tick by tick") {
  PathDevice device(touchAndGo());
  SphereContact sphere(kRadius);
  SteppedClock clock;
  std::atomic<bool> stop = false;
  std::atomic<int> ticks = 0;
  struct Counter final : TickRecorder {
    explicit Counter(std::atomic<int>& its) : ticks(its) {}
    void ticked(const TraceRow&, const DeviceState&) noexcept override { ++ticks; }
    std::atomic<int>& ticks;
  } counter(ticks);
  ServoOptions options{.endless = true, .realtime = true, .clock = &clock, .stop = &stop, .recorder = &counter};
  clock.hold();
  std::thread session([&] {
    ServoLoop(device, sphere, ForceLaw({}, {}), options).run();
    clock.leave();
  });
  clock.goOnTo(0);
  CHECK(ticks == 1);  // the first is due at once
  clock.goOnTo(0.0505);
  CHECK(ticks == 51);
  clock.goOnTo(0.0505);
  CHECK(ticks == 51);
  stop = true;
  clock.letGo();
  session.join();
  CHECK(ticks == 52);  // the tick that it was waiting for
  clock.goOnTo(1);     // no more ticks follow
}

TEST_CASE("a tick that takes too long is not followed by a burst") {
  class SlowSphere : public SphereContact {
   public:
    using SphereContact::SphereContact;
    Contact answerTo(const Pose& pose, double budget_us) noexcept override {
      if (pose.time_s >= 0.05 && !slept_) {
        slept_ = true;
        ::usleep(30'000);
      }
      return SphereContact::answerTo(pose, budget_us);
    }

   private:
    bool slept_ = false;
  };
  PathDevice device(touchAndGo());
  SlowSphere sphere(kRadius);
  const Trace trace = playedOn(sphere, device, lasting(0.15, true)).trace();
  CHECK(trace.missedTicks >= 28);
  CHECK(trace.rows.size() + trace.missedTicks == 150);
}

TEST_CASE("a session has at least one tick, and impossible rates and durations are refused") {
  PathDevice device(touchAndGo());
  SphereContact sphere(kRadius);
  const auto made = [&](const ServoOptions& options) { return ServoLoop(device, sphere, ForceLaw({}, {}), options); };
  CHECK(made(lasting(0)).plannedTicks() == 1);
  CHECK(made(lasting(0.0026)).plannedTicks() == 3);
  for (const double duration_s : {-1.0, 1e12, std::numeric_limits<double>::quiet_NaN()})
    CHECK_THROWS_AS(made(lasting(duration_s)), UsageError);
  for (const double rate_Hz : {0.0, -5.0, 1e9})
    CHECK_THROWS_AS(made({.rate_Hz = rate_Hz, .duration_s = 1}), UsageError);
}

}  // namespace palpate::servo_loop_test
