// Valid and invalid scenes.
#include <cmath>
#include <limits>

#include "engine/core/processor.hpp"
#include "tests/matter/matter_scenes.hpp"
#include "tests/near.hpp"
#include "tests/says.hpp"

namespace palpate::matter_scene_test {

TEST_CASE("a scene that cannot be simulated is refused with the field's name before it starts") {
  const auto with = [](auto change) {
    MatterScene scene;
    change(scene);
    return refusal(scene);
  };
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  CHECK(refusal({}).empty());
  CHECK(says(with([](MatterScene& s) { s.spacing_mm = 0; }), "spacing_mm: is 0;"));
  CHECK(says(with([](MatterScene& s) { s.spacing_mm = -1; }), "spacing_mm: is -1;"));
  CHECK(says(with([](MatterScene& s) { s.spacing_mm = kNaN; }), "spacing_mm: is nan;"));
  CHECK(says(with([](MatterScene& s) { s.box_mm.y = 1; }), "box_mm: is 1;"));
  CHECK(says(with([](MatterScene& s) { s.fill_mm.z = 101; }), "fill_mm: is 101 along z"));
  CHECK(says(with([](MatterScene& s) { s.fill_mm.z = -1; }), "fill_mm: is -1;"));
  CHECK(says(with([](MatterScene& s) { s.density_kg_m3 = 0; }), "density_kg_m3: is 0;"));
  CHECK(says(with([](MatterScene& s) { s.viscosity_Pa_s = -1e-3; }), "viscosity_Pa_s: is -0.001;"));
  CHECK(says(with([](MatterScene& s) { s.viscosity_Pa_s = 1e4; }), "substeps"));
  CHECK(says(with([](MatterScene& s) { s.friction = -0.5; }), "friction: is -0.5;"));
  CHECK(says(with([](MatterScene& s) { s.gravity_m_s2.x = INFINITY; }), "gravity_m_s2: is inf;"));
  CHECK(says(with([](MatterScene& s) { s.gain = -1; }), "gain: is -1;"));
  CHECK(says(with([](MatterScene& s) { s.substeps = 1; }), "substeps: is 1; this scene needs"));
  CHECK(says(with([](MatterScene& s) { s.substeps = 100000; }), "substeps: is 100000;"));
  CHECK(says(with([](MatterScene& s) { s.spacing_mm = 0.4; }), "spacing_mm: makes 7812500 particles"));
  CHECK(says(with([](MatterScene& s) { s.box_mm = DVec3(1e6), s.fill_mm = DVec3(10); }), "spacing_mm: is so small"));
  CHECK(says(with([](MatterScene& s) { s.tool = {.radius_mm = 50, .mass_kg = 10}; }), "tool.radius_mm: is 50; twice"));
  CHECK(says(with([](MatterScene& s) { s.tool = {.radius_mm = 1, .mass_kg = 10}; }), "tool.radius_mm: is 1;"));
  CHECK(says(with([](MatterScene& s) { s.tool = {.radius_mm = 20, .mass_kg = 0.01}; }), "tool.mass_kg: is 0.01;"));
  CHECK(says(with([](MatterScene& s) { s.tool = {.radius_mm = 20, .mass_kg = kNaN}; }), "tool.mass_kg: is nan;"));
  CHECK(says(refusal({}, 1 << 20), "spacing_mm: makes 4000 particles"));
}

TEST_CASE("a scene has the necessary number of substeps, or more if requested") {
  const MatterPlan plan = planOf({});
  CHECK(plan.particles == 20 * 10 * 20);
  CHECK(plan.mass_kg == near(1000 * 5e-3 * 5e-3 * 5e-3, 1e-6));
  CHECK(plan.substeps >= 2);
  MatterScene finer;
  finer.substeps = plan.substeps + 3;
  CHECK(planOf(finer).substeps == plan.substeps + 3);
  CHECK(planOf(finer).speedOfSound_m_s > plan.speedOfSound_m_s);
  MatterScene honey;
  honey.viscosity_Pa_s = 30;
  CHECK(planOf(honey).substeps > plan.substeps);
}

TEST_CASE("particles start on a lattice, half a spacing from the walls") {
  const MatterScene scene{.box_mm = {40, 30, 20}, .fill_mm = {20, 30, 0}, .spacing_mm = 10};
  CHECK(placesAtRest(scene).empty());
  MatterScene filled = scene;
  filled.fill_mm.z = 20;
  const auto places = placesAtRest(filled);
  CHECK(places.size() == 2 * 3 * 2);
  CHECK(places.front() == Vec3(0.005f));
  CHECK(glm::length(places.back() - Vec3(0.015f, 0.025f, 0.015f)) < 1e-7f);
}

TEST_CASE("water and sand have the requested amount, in layers no further apart than the spacing") {
  for (const Matter matter : {Matter::water, Matter::sand})
    for (const DVec3& fill_mm : {DVec3(80, 85, 80), DVec3(80, 15, 80), DVec3(73, 44, 66), DVec3(11, 4, 12)}) {
      const MatterScene scene{
          .matter = matter, .box_mm = {80, 120, 80}, .fill_mm = fill_mm, .spacing_mm = 10, .density_kg_m3 = 1200};
      CAPTURE(fill_mm.x);
      CAPTURE(fill_mm.y);
      const MatterPlan plan = planOf(scene);
      const double asked_m3 = fill_mm.x * fill_mm.y * fill_mm.z * 1e-9;
      CHECK(static_cast<double>(plan.particles) * plan.mass_kg == near(1200 * asked_m3, 1e-9));
      CHECK(plan.spacing_m <= 0.01);
      CHECK(1e3 * plan.spacing_m == particleSpacing_mm(scene));
      for (int k = 0; k < 3; ++k) {
        CHECK(plan.lattice[k] * plan.apart_m[k] == near(1e-3 * fill_mm[k], 1e-12));
        CHECK(plan.apart_m[k] <= 0.01);
      }
      if (matter == Matter::sand) continue;  // grains are slightly displaced at the beginning
      const auto places = placesAtRest(scene);
      for (int k = 0; k < 3; ++k) {
        CHECK(places.front()[k] == near(plan.apart_m[k] / 2, 1e-6));
        CHECK(places.back()[k] == near(1e-3 * fill_mm[k] - plan.apart_m[k] / 2, 1e-6));
      }
    }
  // Whole numbers of spacings are not adjusted, to the bit.
  const MatterPlan whole = planOf({.box_mm = DVec3(100), .fill_mm = {70, 30, 100}, .spacing_mm = 10});
  CHECK(whole.lattice == UVec3(7, 3, 10));
  CHECK(whole.spacing_m == 10 * 1e-3);
  CHECK(whole.apart_m == DVec3(10 * 1e-3));
}

TEST_CASE("a scene is refused only for the memory of the machine that it is to run on") {
  const MatterScene large{.box_mm = DVec3(2000), .fill_mm = DVec3(1000), .spacing_mm = 5};
  CHECK(planOf(large).bytes > std::uint64_t{4} << 30);  // on an unknown machine
  CHECK(refusal(large, std::uint64_t{64} << 30).empty());
  CHECK(refusal(large, std::uint64_t{4} << 30).find("8000000 particles, which take about") != std::string::npos);
  MatterScene beyond = large;
  beyond.spacing_mm = 0.5;
  CHECK(refusal(beyond, kAnyMemory) != "taken");
  CHECK(hostMemory_bytes() > std::uint64_t{64} << 20);
  CHECK(onMachine({}, 1000).memory_bytes == 500);
  CHECK(onMachine({.memory_bytes = 7}, 1000).memory_bytes == 7);
  CHECK(onMachine({}, 0).memory_bytes == kAnyMemory);
  CHECK(atRest(onCpu(), {})->memory_bytes() == hostMemory_bytes() / 2);
  CHECK_THROWS_AS(MatterWorld({}, {.memory_bytes = 1 << 20}), Error);
}

TEST_CASE("built-in scenes need no file, and an unknown name is refused with their list") {
  for (const std::string_view name : matterSceneNames()) CHECK(refusal(matterSceneNamed(name)).empty());
  CHECK_THROWS_WITH(matterSceneNamed("lava"),
                    "unknown scene 'lava'; choose water, dam, sand, statue in water, drop, jelly, soft statue");
}

}  // namespace palpate::matter_scene_test
