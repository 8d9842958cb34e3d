// A session for a person: what its servo thread does around commands and failures.
#include "haptics/session/interactive_session.hpp"

#include <doctest/doctest.h>

#include <memory>

#include "haptics/simulation/matter_choice.hpp"

namespace palpate::interactive_session_test {

TEST_CASE("after a failure of the simulation a command throws, and a restart is still possible") {
  // So fine and weightless that its speed of sound is below the speed of the hand.
  MatterScene scene{.box_mm = DVec3(16), .fill_mm = DVec3(16), .spacing_mm = 2, .gravity_m_s2 = DVec3(0)};
  scene.tool = usualTool(scene);
  SessionConfig config{.model = {.file = "water"}, .backend = {.name = "cpu"}};
  config.model.matter = sceneRef(scene);
  config.duration_s = 0;
  Log log;
  const auto cpu = cpuBackend();
  const auto clock = std::make_shared<SteppedClock>();
  InteractiveSession session(config, loadModel(config.model, {.log = log, .threads = 1}),
                             {.backend = *cpu, .threads = 1}, {.clock = clock});
  double until_s = 0;
  const auto hasFailed = [&] { return !session.session().simulation()->failure().empty(); };
  for (int beat = 0; beat < 2'000 && !hasFailed(); ++beat) {
    session.aim({8, beat % 2 ? 30 : -14, 8});
    CHECK_FALSE(session.tickUntil(until_s += 0.02));
  }
  REQUIRE(hasFailed());
  ForceOptions force = config.force;
  force.stiffness_N_per_mm /= 2;
  CHECK_THROWS_WITH_AS(session.setContact(config.surface, force, ""), doctest::Contains("the simulation"), Error);
  CHECK(session.isTouching());
  session.lift();
  session.session().simulation()->reset();
  const std::uint64_t before = session.recentTicks().ticks();
  CHECK_FALSE(session.tickUntil(until_s += 0.2));
  CHECK(session.recentTicks().ticks() > before + 50);
  CHECK_FALSE(hasFailed());
  CHECK_NOTHROW(session.setContact(config.surface, force, ""));
}

}  // namespace palpate::interactive_session_test
