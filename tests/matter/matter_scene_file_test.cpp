// Scenes of matter as files.
#include "engine/matter/matter_scene_file.hpp"

#include <doctest/doctest.h>

#include <fstream>

#include "engine/core/error.hpp"
#include "tests/error_of.hpp"
#include "tests/says.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate::matter_scene_file_test {

namespace {

constexpr const char* kMin = R"("box_mm": [100, 80, 60], "fill_mm": [50, 40, 60], "spacing_mm": 5)";

std::string refusal(const std::string& json) {
  return errorOf([&] { parseMatterScene(json); });
}

std::string waterWith(const std::string& more) {
  return std::string(R"({"matter": "water", )") + kMin + ", " + more + "}";
}

std::string softWith(const std::string& more) {
  return std::string(R"({"matter": "soft", )") + kMin + ", " + more + "}";
}

}  // namespace

TEST_CASE("a scene of matter is read with all its fields") {
  const MatterScene water = parseMatterScene(waterWith(
      R"("density_kg_m3": 900, "viscosity_Pa_s": 0.1, "gravity_m_s2": [0, 0, -5], "substeps": 9,
         "tool": {"radius_mm": 12, "mass_kg": 0.2}, "gain": 40)"));
  CHECK(water == MatterScene{.matter = Matter::water,
                             .box_mm = {100, 80, 60},
                             .fill_mm = {50, 40, 60},
                             .spacing_mm = 5,
                             .density_kg_m3 = 900,
                             .viscosity_Pa_s = 0.1,
                             .gravity_m_s2 = {0, 0, -5},
                             .substeps = 9,
                             .tool = {.radius_mm = 12, .mass_kg = 0.2},
                             .gain = 40});
  const MatterScene sand = parseMatterScene(std::string(R"({"friction": 0.3, "matter": "sand", )") + kMin + "}");
  CHECK(sand.matter == Matter::sand);
  CHECK(sand.friction == 0.3);
  CHECK(sand.density_kg_m3 == MatterScene{}.density_kg_m3);
  const MatterScene soft = parseMatterScene(softWith(
      R"("young_Pa": 5e4, "poisson": 0.3, "viscosity_Pa_s": 7, "friction": 0.2, "shape": "ball",
         "pinned_mm": [[0, 0, 0], [100, 1, 60]])"));
  CHECK(soft == MatterScene{.matter = Matter::soft,
                            .box_mm = {100, 80, 60},
                            .fill_mm = {50, 40, 60},
                            .spacing_mm = 5,
                            .viscosity_Pa_s = 7,
                            .friction = 0.2,
                            .young_Pa = 5e4,
                            .poisson = 0.3,
                            .shape = SoftShape::ball,
                            .pinned_mm = {{DVec3(0), DVec3(100, 1, 60)}}});
  CHECK(parseMatterScene(softWith(R"("preset": "elastic", "poisson": 0.2)")).poisson == 0.2);
  const MatterScene scan = parseMatterScene(softWith(R"("model": "bunny.ply", "hole_mm": 12)"));
  CHECK(scan.hole_mm == 12);
  CHECK(scan.model == "bunny.ply");
  CHECK(scan.viscosity_Pa_s == kSoftViscosity_Pa_s);
}

TEST_CASE("an invalid scene of matter is refused with the field") {
  CHECK(refusal(waterWith(R"("gain": 1)")).empty());
  CHECK(says(refusal("{"), "is not valid JSON"));
  CHECK(says(refusal("[]"), "is not a JSON object"));
  CHECK(says(refusal("{}"), "matter: is missing"));
  CHECK(says(refusal(R"({"matter": "water"})"), "box_mm: is missing"));
  CHECK(says(refusal(std::string(R"({"matter": "lava", )") + kMin + "}"), "choose water, sand, soft"));
  CHECK(says(refusal(waterWith(R"("colour": 1000)")), "colour: unknown key 'colour'; choose matter, box_mm"));
  CHECK(says(refusal(waterWith(R"("young_Pa": 1000)")), "young_Pa: does not apply to water"));
  CHECK(says(refusal(softWith(R"("young_Pa": "soft")")), "young_Pa: is"));
  CHECK(says(refusal(softWith(R"("model": 3)")), "model: is 3, not a text"));
  CHECK(says(refusal(softWith(R"("model": "")")), "model: is empty, not the name of a file"));
  CHECK(says(refusal(softWith(R"("shape": "cone")")), "choose box, ball"));
  for (const char* preset : {"rubber", "shape-matching"})
    CHECK(says(refusal(softWith(fmt::format(R"("preset": "{}")", preset))),
               fmt::format("preset: is \"{}\"; only elastic is left: use young_Pa", preset)));
  CHECK(says(refusal(softWith(R"("stiffness": 0.5)")), "stiffness: unknown key 'stiffness'"));
  CHECK(says(refusal(waterWith(R"("preset": "elastic")")), "preset: does not apply to water"));
  CHECK(
      says(refusal(softWith(R"("pinned_mm": [1, 2, 3])")), "pinned_mm: is [1,2,3], not a list of 2 corners of a box"));
  CHECK(says(refusal(softWith(R"("pinned_mm": [[0, 0, 0], [1, 2]])")), "pinned_mm: is [1,2], not a list of 3 numbers"));
  CHECK(says(refusal(std::string(R"({"matter": "sand", "poisson": 0.3, )") + kMin + "}"),
             "poisson: does not apply to sand"));
  CHECK(says(refusal(waterWith(R"("friction": 0.5)")), "friction: does not apply to water"));
  CHECK(says(refusal(waterWith(R"("gain": "much")")), "gain: is"));
  CHECK(says(refusal(waterWith(R"("gain": null)")), "gain: is"));
  CHECK(says(refusal(waterWith(R"("gravity_m_s2": [0, 1])")), "gravity_m_s2: is [0,1], not a list of 3 numbers"));
  CHECK(says(refusal(waterWith(R"("gravity_m_s2": [0, 1, "2"])")), "gravity_m_s2: is"));
  CHECK(says(refusal(waterWith(R"("substeps": 1.5)")), "substeps: is 1.5, not a whole number"));
  CHECK(says(refusal(waterWith(R"("tool": 3)")), "tool: is not an object"));
  CHECK(says(refusal(waterWith(R"("tool": {"colour": 3})")), "tool.colour: unknown key 'colour'"));
  CHECK(says(refusal(waterWith(R"("tool": {"mass_kg": "3"})")), "tool.mass_kg: is"));
}

TEST_CASE("an invalid scene file is refused with its name, the field and the bounds") {
  const ScratchFolder folder;
  const auto file = folder / "scene.json";
  const auto readRefusal = [&](const std::string& text) {
    std::ofstream(file) << text;
    try {
      readMatterScene(file);
    } catch (const FileError& error) {
      return std::string(error.what());
    }
    return std::string("read");
  };
  CHECK(readRefusal(waterWith(R"("gain": 1)")) == "read");
  CHECK(says(readRefusal(waterWith(R"("gain": -1)")), "scene.json: gain: is -1; it must be from 0 to"));
  CHECK(says(readRefusal(waterWith(R"("density_kg_m3": 0)")), "scene.json: density_kg_m3: is 0;"));
  CHECK(says(readRefusal(softWith(R"("poisson": 0.5)")), "scene.json: poisson: is 0.5; it must be from 0 to 0.49"));
  CHECK(says(readRefusal(softWith(R"("young_Pa": -5)")), "scene.json: young_Pa: is -5;"));
  CHECK(readRefusal(softWith(R"("model": "scan.ply")")) == "read");
  CHECK(readMatterScene(file).model == (folder / "scan.ply").string());
  CHECK(says(readRefusal(""), "scene.json: is not valid JSON"));
  CHECK(says(readRefusal(std::string(2 << 20, ' ')), "scene.json: is too long"));
}

}  // namespace palpate::matter_scene_file_test
