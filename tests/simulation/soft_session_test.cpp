// Sessions with a soft body, on the CPU, in virtual time.
#include <doctest/doctest.h>

#include "engine/io/ply_writer.hpp"
#include "haptics/session/session.hpp"
#include "haptics/simulation/matter_choice.hpp"
#include "haptics/simulation/scene_model.hpp"
#include "tests/near.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/session/session_scene.hpp"

namespace palpate::soft_session_test {

namespace {

MatterScene block() {
  return {
      .matter = Matter::soft, .box_mm = {100, 100, 100}, .fill_mm = {40, 30, 40}, .spacing_mm = 5, .viscosity_Pa_s = 3};
}

SessionConfig softSession(const MatterScene& scene = block()) {
  SessionConfig config{.model = {.file = "block"},
                       .backend = {.name = "cpu"},
                       .force = {.stiffness_N_per_mm = 0.5, .damping_N_s_per_mm = 0},
                       .duration_s = 0.4};
  config.model.matter = sceneRef(scene);
  return config;
}

Path pressed() { return Path({{0, {50, 33, 50}}, {0.2, {50, 25, 50}}, {0.4, {50, 25, 50}}}); }

Model modelOf(const SessionConfig& config) {
  Log log;
  return loadModel(config.model, {.log = log, .threads = 1});
}

/// Replays a log, checks its forces and points, and returns its configuration.
SessionConfig replayedConfig(const std::string& file, const Trace& trace, const PointCloud& dented) {
  SessionRecord record = readSessionLog(file);
  const RecordedSession recorded = parseHeader(file, record.text);
  const auto cpu = cpuBackend();
  Session again(recorded.config, modelOf(recorded.config), {.backend = *cpu, .threads = 2});
  CHECK(sameTrace(trace, runAgain(again, std::move(record), recorded).trace()));
  again.finish();
  CHECK(again.sculpted().cloud.positions == dented.positions);
  return recorded.config;
}

}  // namespace

TEST_CASE("a soft body is touched, dented and recorded, and a replay gives the same forces") {
  const ScratchFolder folder;
  const std::string file = (folder / "log").string();
  const auto cpu = cpuBackend();
  const SessionConfig config = softSession();
  Session session(config, modelOf(config), {.backend = *cpu, .threads = 1, .keepsPoints = true});
  const ServoResult result = runRecorded(session, file, pressed());
  double most_N = 0;
  for (const TraceRow& row : result.trace().rows) {
    CHECK(row.valid);
    CHECK(row.force_N.y >= 0);
    most_N = std::max(most_N, row.force_N.y);
  }
  CHECK(most_N > 0.3);
  CHECK(most_N < 0.5 * 5);  // it yields
  const SculptedCloud dented = session.sculpted();
  CHECK(dented.edited > 100);
  CHECK(dented.cloud.size() == session.model().cloud.size());
  CHECK(replayedConfig(file, result.trace(), dented.cloud).model.matter == config.model.matter);
}

TEST_CASE("a sculpted soft body keeps its dent, a replay gives the same forces, and undo removes it") {
  const ScratchFolder folder;
  const std::string file = (folder / "log").string();
  const auto cpu = cpuBackend();
  SessionConfig config = softSession();
  config.brush = BrushConfig{.radius_mm = 10};
  config.duration_s = 1;
  const Path path(
      {{0, {50, 33, 50}}, {0.2, {50, 25, 50}}, {0.5, {50, 25, 50}}, {0.6, {50, 40, 50}}, {1, {50, 40, 50}}});
  Session session(config, modelOf(config), {.backend = *cpu, .threads = 1, .keepsPoints = true, .undo = {1 << 24}});
  const ServoResult result = runRecorded(session, file, path);
  const auto top = [](const PointCloud& cloud) {
    float lowest = 100;
    for (const Vec3& position : cloud.positions)
      if (position.y > 20 && glm::length(glm::vec2(position.x - 50, position.z - 50)) < 4)
        lowest = std::min(lowest, position.y);
    return lowest;
  };
  const SculptedCloud dented = session.sculpted();
  CHECK(top(dented.cloud) < 27.5f);
  CHECK(replayedConfig(file, result.trace(), dented.cloud).brush == config.brush);

  session.finish();
  const UndoneStrokes undone = session.undo(3, 0);
  CHECK(undone.strokes == 1);
  CHECK(undone.undone == 1);
  CHECK(top(session.sculpted().cloud) > 29);
  CHECK(session.undo(0, 1).redone == 1);
  CHECK(top(session.sculpted().cloud) < 27.5f);
}

TEST_CASE("a brush that a soft body cannot take is refused with the reason") {
  const auto refused = [](const BrushConfig& brush, const char* why) {
    SessionConfig config = softSession();
    config.brush = brush;
    CHECK_THROWS_WITH_AS(validate(config), doctest::Contains(why), ConfigError);
  };
  refused({.kind = BrushKind::carve}, "keeps its cells");
  refused({.kind = BrushKind::paint}, "cannot be painted");
  refused({.radius_mm = 4.9}, "5 mm wide");
  SessionConfig config = softSession();
  config.brush = BrushConfig{.radius_mm = 5};
  validate(config);
  config.model.mm_per_unit = 2;  // in the hand its cells are twice as wide
  CHECK_THROWS_WITH_AS(validate(config), doctest::Contains("10 mm wide"), ConfigError);
}

TEST_CASE("a log with the former settings of shape matching is read if its body is elastic, and refused otherwise") {
  const SessionConfig config = softSession();
  std::string text = configText(config);
  CHECK(parseConfig(text).model.matter == config.model.matter);
  const std::size_t at = text.find("\"shape\"");
  REQUIRE(at != std::string::npos);
  text.insert(at, R"("preset": "elastic", "stiffness": 0.5, )");
  CHECK(parseConfig(text).model.matter == config.model.matter);
  text.replace(text.find("elastic"), 7, "shape-matching");
  CHECK_THROWS_WITH_AS(parseConfig(text), doctest::Contains("matter.preset: is \"shape-matching\""), ConfigError);
}

TEST_CASE("the force on the hand is the force on the soft body, at any model scale") {
  for (const double mm_per_unit : {1.0, 0.5}) {
    CAPTURE(mm_per_unit);
    SessionConfig config = softSession();
    config.model.mm_per_unit = mm_per_unit;
    const auto cpu = cpuBackend();
    Session session(config, modelOf(config), {.backend = *cpu, .threads = 1});
    const ServoResult result = runAlone(session, pressed());
    const TraceRow& last = result.trace().rows.back();
    CHECK(last.contact);
    // At rest the force is the hand's stiffness, in file units, times the spring's stretch.
    CHECK(last.force_N.y == near(0.5 * mm_per_unit * (last.proxy.y - last.hip.y), 0.01));
    // Displacement of a body of that stiffness, less with half the spring.
    CHECK(30 - last.proxy.y > (mm_per_unit < 1 ? 0.5 : 1.0));
    CHECK(30 - last.proxy.y < (mm_per_unit < 1 ? 3.0 : 4.5));
  }
}

TEST_CASE("a scan is filled, felt and dented like a shape, and an open scan is refused") {
  const ScratchFolder folder;
  const std::string file = (folder / "ball.ply").string();
  writePly(file, makeScene("sphere", 6'000).cloud);
  MatterScene scene = block();
  scene.model = file;
  scene.fill_mm = {40, 40, 40};
  SessionConfig config = softSession(scene);
  const auto cpu = cpuBackend();
  const Model model = modelOf(config);
  CHECK(model.cloud.size() == 6'000);
  CHECK(boundsOf(model.cloud).longestSide() == near(40, 0.01));
  REQUIRE(model.as<SoftPoints>());
  Session session(config, model, {.backend = *cpu, .threads = 1});
  const ServoResult result = runAlone(session, Path({{0, {50, 43, 50}}, {0.3, {50, 36, 50}}}));
  CHECK(result.trace().rows.back().contact);
  session.finish();
  CHECK(session.sculpted().edited > 1'000);
  scene.model = (folder / "none.ply").string();
  config.model.matter = sceneRef(scene);
  CHECK_THROWS_AS(modelOf(config), Error);
}

TEST_CASE("the built-in scenes of soft bodies can be touched") {
  for (const char* name : {"jelly", "soft statue"}) {
    CAPTURE(name);
    const Model model = modelOf(softSession(matterSceneNamed(name)));
    CHECK(model.cloud.hasNormals());
    CHECK(model.ballRadius() == 0);
    CHECK(softBodyOf(model)->solid.lattice.nodes() > 1'000);
    CHECK(boundsOf(model.cloud).longestSide() > 70);
  }
}

}  // namespace palpate::soft_session_test
