// What can be done with each kind of model: the table is walked, and what a session does is held against it.
#include "haptics/session/abilities.hpp"

#include <doctest/doctest.h>

#include <map>

#include "haptics/session/backends.hpp"
#include "haptics/session/simulation.hpp"
#include "tests/error_of.hpp"
#include "tests/session/session_scene.hpp"

namespace palpate::abilities_test {

namespace {

// Configurations of the kinds of models that one can make.
std::map<ModelKind, SessionConfig> configured() {
  const SessionConfig file{.model = {.file = "model.ply"}};
  std::map<ModelKind, SessionConfig> made{{ModelKind::cloud, file}};
  made[ModelKind::moved] = file;
  made[ModelKind::moved].motion = MotionConfig{};
  made[ModelKind::frames] = file;
  made[ModelKind::frames].model.stream = StreamConfig{};
  made[ModelKind::liveFrames] = file;
  made[ModelKind::liveFrames].model.stream = StreamConfig{.live = true};
  made[ModelKind::liveFrames].realtime = true;
  if (canSimulate()) {
    made[ModelKind::fluid] = file;
    made[ModelKind::fluid].model.matter = sceneNamed("water");
    made[ModelKind::soft] = file;
    made[ModelKind::soft].model.matter = sceneNamed("jelly");
  }
  made[ModelKind::shared] = file;
  made[ModelKind::shared].model.join = JoinConfig{};
  made[ModelKind::partial] = file;
  made[ModelKind::partial].model.join = JoinConfig{.partial = true};
  return made;
}

// What a check says of a configuration; empty: nothing.
template <class Check>
std::string saidBy(Check check) {
  return errorOf<ConfigError>([&] { check(); });
}

}  // namespace

TEST_CASE("brushes, motion and undo are refused for each kind of model as the table says, with its message") {
  const auto cpu = cpuBackend();
  std::size_t allowed = 0, refused = 0;
  const auto hold = [&](const SessionConfig& config, Action action, const std::string& field) {
    const Abilities can(modelKindOf(config));
    CAPTURE(static_cast<int>(can.kind()));
    CAPTURE(static_cast<int>(action));
    const std::string said = saidBy([&] {
      validate(config);
      cpu->check(config);
    });
    CHECK(said == (can.allow(action) ? std::string() : field + ": " + can.refusal(action)));
    ++(can.allow(action) ? allowed : refused);
  };
  for (const auto& [modelKind, plain] : configured()) {
    CHECK(modelKindOf(plain) == modelKind);
    for (const auto& [name, kind] : kBrushKinds) {
      SessionConfig config = plain;
      config.brush = BrushConfig{.kind = kind, .radius_mm = 20, .resample = false};
      hold(config, actionOf(kind), "brush.kind");
      config.brush->resample = true;
      if (Abilities(modelKind).allow(actionOf(kind))) hold(config, Action::insertPoints, "brush.resample");
      config.brush->resample = false;
      config.brush->symmetry = "x";
      if (Abilities(modelKind).allow(actionOf(kind))) hold(config, Action::mirror, "brush.symmetry");
    }
    SessionConfig moved = plain;
    moved.motion = MotionConfig{};
    hold(moved, Action::move, "motion.kind");
    SessionConfig undone = plain;
    undone.undo.undo = 1;
    hold(undone, Action::undo, "undo.undo");
  }
  CHECK(allowed > 30);
  CHECK(refused > 25);
}

TEST_CASE("each refusal has its own message, and a model that cannot be sculpted refuses all that requires sculpting") {
  for (std::size_t s = 0; s < kModelKinds; ++s) {
    const Abilities can(static_cast<ModelKind>(s));
    for (std::size_t a = 0; a < kActions; ++a) {
      const std::string& said = can.refusal(static_cast<Action>(a));
      CHECK((said.empty() || (said.size() > 15 && said.back() != '.')));
    }
    if (can.allow(Action::sculpt)) continue;
    for (const Action action : {Action::carve, Action::paint, Action::insertPoints})
      CHECK(can.refusal(action) == can.refusal(Action::sculpt));
  }
  const Abilities all(ModelKind::cloud);
  for (std::size_t a = 0; a < kActions; ++a) CHECK(all.allow(static_cast<Action>(a)));
}

TEST_CASE("a back end that does not report its edits can neither undo nor record, and the session says so") {
  const Abilities can(ModelKind::cloud, {.keepsEdits = false}, "cuda");
  const std::string why = "back end cuda does not report its edits; use vulkan or cpu";
  CHECK(can.refusal(Action::undo) == why);
  CHECK(can.refusal(Action::record) == why);
  CHECK(can.allow(Action::sculpt));
  CHECK_THROWS_WITH_AS(can.require(Action::record, "--log"), ("--log: " + why).c_str(), UsageError);
  can.require(Action::save, "--save");
}

TEST_CASE("a session has the abilities of its model: all at rest, no brush and no recording under a program's source") {
  const Model model = sphereModel(2000);
  const auto cpu = cpuBackend();
  const SessionConfig config{.model = {.file = "sphere"}};
  Session still(config, model, {.backend = *cpu, .threads = 1});
  CHECK(still.abilities().kind() == ModelKind::cloud);
  still.require(Action::record, "log");
  SessionConfig joined = config;
  joined.model.join = JoinConfig{};
  CHECK(modelKindOf(joined, model) == ModelKind::readOnly);
  CHECK(modelKindOf(config, model, true) == ModelKind::programFrames);
  CHECK_FALSE(Abilities(ModelKind::programFrames).allow(Action::sculpt));
  CHECK_FALSE(Abilities(ModelKind::programFrames).allow(Action::record));
}

}  // namespace palpate::abilities_test
