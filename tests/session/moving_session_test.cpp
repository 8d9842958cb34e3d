// Sessions with a moving model, on the CPU, in virtual time.
#include <doctest/doctest.h>

#include <random>

#include "haptics/session/interactive_session.hpp"
#include "tests/moving_shape.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/session/config_fault.hpp"
#include "tests/session/session_scene.hpp"

namespace palpate::moving_session_test {

namespace {

SessionConfig moving(const MotionConfig& motion = {.amplitude_mm = 2, .frequency_Hz = 5}) {
  return {.backend = {.name = "cpu"},
          .force = {.stiffness_N_per_mm = 0.5, .damping_N_s_per_mm = 0},
          .motion = motion,
          .duration_s = 0.25};
}

SessionConfig still() {
  SessionConfig config = moving();
  config.motion.reset();
  return config;
}

/// At rest, just above the top of the sphere of radius 50.
Path atRest() {
  const DVec3 hip(0, 0, 50.2);
  return Path({{0, hip}, {0.25, hip}});
}

}  // namespace

TEST_CASE("a hand at rest feels stiffness times the exact depth of an oscillating sphere") {
  const auto cpu = cpuBackend();
  Session session(moving(), sphereModel(20'000), {.backend = *cpu, .threads = 1});
  const ServoResult result = runAlone(session, atRest());
  session.finish();
  const auto shape = makeShape("sphere", 100.0, DVec3(0));
  const MovingShape truth(*shape, *rigidMotion(session.config(), session.model()));
  double squares = 0, forces = 0;
  std::size_t pushed = 0, wrong = 0;
  for (const TraceRow& row : result.trace().rows) {
    const double depth = -truth.signedDistance(row.hip, row.time_s), exact_N = 0.5 * std::max(0.0, depth);
    const double felt_N = glm::length(row.force_N);
    squares += (felt_N - exact_N) * (felt_N - exact_N);
    forces += exact_N * exact_N;
    pushed += felt_N > 0.1;
    wrong += depth < -0.2 && felt_N != 0;
    CHECK(row.valid);
  }
  CHECK(pushed > 80);
  CHECK(wrong == 0);
  CHECK(std::sqrt(squares / forces) < 0.03);
  CHECK(session.sculpted().edited == 20'000);
}

TEST_CASE("no hand gets more than a millijoule out of a moving surface") {
  const auto cpu = cpuBackend();
  for (const MotionConfig& motion :
       {MotionConfig{.amplitude_mm = 2, .frequency_Hz = 5}, MotionConfig{.amplitude_mm = 10, .frequency_Hz = 1},
        MotionConfig{.kind = MotionKind::drift, .speed_mm_per_s = 20},
        MotionConfig{.kind = MotionKind::turn, .frequency_Hz = 0.5}}) {
    CAPTURE(motion.amplitude_mm);
    for (const double friction : {0.0, 0.4}) {
      SessionConfig config = moving(motion);
      config.surface.friction = friction;
      config.force.damping_N_s_per_mm = 0.002;
      config.duration_s = 1;
      Session session(config, sphereModel(), {.backend = *cpu, .threads = 1});
      // A random position over the sphere, up to 3 mm inside or outside, every 20 ms.
      std::mt19937 random(7);
      std::uniform_real_distribution<double> aside(-0.06, 0.06), height(47, 53);
      std::vector<PathKey> way;
      for (int i = 0; i <= 50; ++i) {
        const double x = aside(random), y = aside(random);
        way.push_back({0.02 * i, height(random) * glm::normalize(DVec3(x, y, 1))});
      }
      const PathHand path{Path(std::move(way))};
      OpenHand hand = path.hand();
      hand.passivity = PassivityMode::observe;
      const ServoResult result = session.run({&hand, 1}, {});
      CHECK(summarize(result.trace()).contactTicks > 300);
      REQUIRE(result.counts().leastEnergy_mJ);
      CHECK(*result.counts().leastEnergy_mJ >= -1);
    }
  }
}

TEST_CASE("a motion without extent leaves the trace of no motion, bit for bit") {
  const auto cpu = cpuBackend();
  const auto traceOf = [&](const SessionConfig& config) {
    Session session(config, sphereModel(), {.backend = *cpu, .threads = 1});
    return runAlone(session, strokeFrom({0.2, -0.3, 1}, 1)).trace();
  };
  const Trace alone = traceOf(still());
  CHECK(summarize(alone).contactTicks > 80);
  for (const MotionConfig& motion :
       {MotionConfig{.amplitude_mm = 0}, MotionConfig{.kind = MotionKind::drift, .speed_mm_per_s = 0},
        MotionConfig{.kind = MotionKind::turn, .frequency_Hz = 0}})
    CHECK(sameTrace(alone, traceOf(moving(motion))));
  CHECK_FALSE(sameTrace(alone, traceOf(moving())));
}

TEST_CASE("a recorded session with a moving model is replayed from its configuration alone") {
  const ScratchFolder folder;
  const std::string log = (folder / "log").string();
  const auto cpu = cpuBackend();
  SessionConfig config =
      moving({.kind = MotionKind::oscillate, .axis = {0, 0.1, 2}, .amplitude_mm = 1, .frequency_Hz = 5});
  config.model.file = (folder / "model.ply").string();
  Session session(config, sphereModel(), {.backend = *cpu, .threads = 1, .keepsPoints = true});
  const ServoResult result = runRecorded(session, log, atRest());

  SessionRecord record = readSessionLog(log);
  const RecordedSession recorded = parseHeader(log, record.text);
  CHECK(recorded.config == config);
  Session again(recorded.config, sphereModel(), {.backend = *cpu, .threads = 1, .keepsPoints = true});
  const ServoResult same = runAgain(again, std::move(record), recorded);
  CHECK(summarize(result.trace()).contactTicks > 60);
  CHECK(sameTrace(result.trace(), same.trace()));
}

TEST_CASE("a configuration's text has a motion only if there is one") {
  CHECK(configText(still()).find("motion") == std::string::npos);
  const SessionConfig turning =
      moving({.kind = MotionKind::turn, .axis = {1, 0, -2}, .amplitude_mm = 0, .frequency_Hz = 3, .speed_mm_per_s = 7});
  CHECK(parseConfig(configText(turning)) == turning);
  SessionConfig usual;
  usual.motion.emplace();
  CHECK(parseConfig(R"({"version": 1, "motion": {}})") == usual);
  CHECK(parseConfig(R"({"version": 1, "motion": null})") == SessionConfig{});
}

TEST_CASE("settings that are incompatible with a motion are refused by field name") {
  CHECK(faultOf(moving()).empty());
  const auto with = [](auto&& change) {
    SessionConfig config = moving();
    change(config);
    return faultOf(config);
  };
  CHECK(with([](auto& c) { c.brush.emplace(); }) == "brush.kind");
  CHECK(with([](auto& c) { c.surface.friction = 0.1; }).empty());
  CHECK(with([](auto& c) { c.motion->axis = DVec3(0); }) == "motion.axis");
  CHECK(with([](auto& c) { c.motion->axis.x = std::numeric_limits<double>::infinity(); }) == "motion.axis");
  CHECK(with([](auto& c) { c.motion->amplitude_mm = -1; }) == "motion.amplitude_mm");
  CHECK(with([](auto& c) { c.motion->frequency_Hz = 1e9; }) == "motion.frequency_Hz");
  CHECK(with([](auto& c) { c.motion->speed_mm_per_s = std::nan(""); }) == "motion.speed_mm_per_s");
}

TEST_CASE("in an endless real-time session a model moves under a stylus at rest and refuses a brush") {
  const auto cpu = cpuBackend();
  SessionConfig config = moving({.amplitude_mm = 2, .frequency_Hz = 10});
  config.duration_s = 0;
  const auto clock = std::make_shared<SteppedClock>();
  InteractiveSession session(config, sphereModel(), {.backend = *cpu, .threads = 1}, {.clock = clock});
  CHECK_THROWS_AS(session.setBrush(BrushConfig{}), ConfigError);
  session.aim({0, 0, 50.2});
  CHECK_FALSE(session.tickUntil(0.4));
  std::size_t touched = 0, ticks = 0;
  for (const TraceRow& row : session.recentTicks().rows()) {
    ++ticks;
    touched += row.contact;
    CHECK(row.valid);
  }
  CHECK(touched > ticks / 5);
  CHECK(touched < 4 * ticks / 5);
}

}  // namespace palpate::moving_session_test
