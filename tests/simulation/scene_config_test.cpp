// Scenes in the configuration of a session.
#include <doctest/doctest.h>

#include "haptics/session/session_config.hpp"
#include "haptics/simulation/matter_choice.hpp"
#include "tests/session/config_fault.hpp"

namespace palpate::scene_config_test {

TEST_CASE("a scene of matter is kept whole in the text, and incompatible settings are refused by name") {
  SessionConfig config{.model = {.file = "tank"}};
  MatterScene scene{.matter = Matter::sand,
                    .box_mm = {60, 70, 80},
                    .fill_mm = {60, 20, 30},
                    .spacing_mm = 7,
                    .density_kg_m3 = 1234,
                    .viscosity_Pa_s = 0.25,
                    .friction = 0.75,
                    .gravity_m_s2 = {1, -2, 3},
                    .substeps = 77,
                    .tool = {.radius_mm = 8, .mass_kg = 0.5},
                    .gain = 2.5};
  config.model.matter = sceneRef(scene);
  CHECK(parseConfig(configText(config)) == config);
  CHECK(faultOf(config).empty());
  CHECK(config.moves());
  const auto with = [&](auto&& change) {
    SessionConfig other = config;
    change(other);
    return faultOf(other);
  };
  const auto withScene = [&](auto&& change) {
    MatterScene other = scene;
    change(other);
    return with([&](auto& c) { c.model.matter = sceneRef(other); });
  };
  CHECK(withScene([](auto& s) { s.spacing_mm = 0; }) == "matter");
  CHECK(withScene([](auto& s) { s.tool.radius_mm = 0; }) == "matter.tool.radius_mm");
  CHECK(withScene([](auto& s) { s.periodic[0] = true; }).starts_with("matter"));
  CHECK(with([](auto& c) { c.brush.emplace(); }) == "brush.kind");
  CHECK(with([](auto& c) { c.motion.emplace(); }) == "motion.kind");
  CHECK(with([](auto& c) { c.model.stream.emplace(); }) == "stream");
  CHECK(with([](auto& c) { c.tool.kind = ToolKind::ball; }) == "tool.kind");
}

TEST_CASE("a scene of a soft body is kept whole in the text, and allows tools of many points") {
  SessionConfig config{.model = {.file = "jelly"}, .tool = {.kind = ToolKind::pad}};
  MatterScene scene{.matter = Matter::soft,
                    .box_mm = {60, 70, 80},
                    .fill_mm = {60, 20, 30},
                    .spacing_mm = 7,
                    .viscosity_Pa_s = 0.25,
                    .young_Pa = 12345,
                    .poisson = 0.25,
                    .shape = SoftShape::ball,
                    .hole_mm = 3,
                    .pinned_mm = {{DVec3(1, 2, 3), DVec3(4, 5, 6)}},
                    .gain = 2};
  config.model.matter = sceneRef(scene);
  CHECK(parseConfig(configText(config)) == config);
  CHECK(faultOf(config).empty());
  scene.shape = SoftShape::box;
  scene.model = "scan.ply";
  scene.pinned_mm.reset();
  config.model.matter = sceneRef(scene);
  CHECK(parseConfig(configText(config)) == config);
  scene.gain = 0;
  config.model.matter = sceneRef(scene);
  CHECK(faultOf(config) == "matter.gain");
  scene.gain = 1;
  config.model.matter = sceneRef(scene);
  config.brush = BrushConfig{.radius_mm = scene.spacing_mm};
  CHECK(faultOf(config).empty());
  config.brush->kind = BrushKind::carve;
  CHECK(faultOf(config) == "brush.kind");
  config.brush = BrushConfig{.radius_mm = scene.spacing_mm / 2};
  CHECK(faultOf(config) == "brush.radius_mm");
}

}  // namespace palpate::scene_config_test
