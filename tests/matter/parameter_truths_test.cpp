// Parameters that change during a simulation, on each back end.
#include "engine/matter/matter_parameters.hpp"
#include "tests/labels.hpp"
#include "tests/matter/on_matter.hpp"

namespace palpate::parameter_truths_test {

namespace {

MatterScene with(MatterScene scene, std::string_view name, double value) {
  setParameter(scene, name, value);
  return scene;
}

// A simulation that begins with a parameter and one that receives it are identical from then on.
void checkTaken(const MatterMaker& make, const MatterScene& scene, std::string_view name, double value, int steps) {
  CAPTURE(name);
  const MatterScene changed = with(scene, name, value);
  const auto is = atRest(make, changed), becomes = atRest(make, scene), stays = atRest(make, scene);
  becomes->change(changed);
  CHECK(becomes->scene() == changed);
  CHECK(becomes->plan().substeps == is->plan().substeps);
  run(*is, steps);
  run(*becomes, steps);
  run(*stays, steps);
  CHECK(sameBytes(*is, *becomes));
  CHECK(!sameBytes(*is, *stays));
}

}  // namespace

TEST_CASE_FIXTURE(OnMatter,
                  "a simulation with a changed parameter continues like one that started with it" * kMoreInFull) {
  const int steps = onCpuOrGpu(20, byTier(3, 8));
  const MatterScene water{.box_mm = DVec3(80), .fill_mm = {40, 60, 80}, .spacing_mm = 10};
  checkTaken(make, water, "viscosity_Pa_s", 50, steps);  // with more substeps
  CHECK(planOf(with(water, "viscosity_Pa_s", 50)).substeps > planOf(water).substeps);
  checkTaken(make, water, "cohesion_N_m", 0.5, steps);
  checkTaken(make, water, "gravity_x_m_s2", -3, steps);
  MatterScene sand = water;
  sand.matter = Matter::sand;
  checkTaken(make, sand, "friction", 0.1, steps);
  checkTaken(make, sand, "gravity_y_m_s2", -5, steps);  // with fewer
}

TEST_CASE_FIXTURE(OnMatter, "a parameter change alone moves nothing, and a refused one changes nothing" * kMoreInFull) {
  const int steps = onCpuOrGpu(60, byTier(8, 20));
  const MatterScene scene{.box_mm = DVec3(80), .fill_mm = {40, 60, 80}, .spacing_mm = 10};
  const auto world = atRest(make, scene);
  run(*world, steps);
  const std::vector<Vec3> places = world->positionsById(), velocities = world->velocitiesById();
  const MatterImpulses before = world->impulses();
  world->change(with(scene, "viscosity_Pa_s", 30));
  CHECK(world->positionsById() == places);
  CHECK(world->velocitiesById() == velocities);
  run(*world, steps);
  CHECK(missingMomentum(*world) <= 1e-5);  // over everything since the beginning
  CHECK(glm::length(world->impulses().gravity) > 1.5 * glm::length(before.gravity));
  // Without gravity nothing falls; a rejected scene changes nothing.
  world->change(with(world->scene(), "gravity_y_m_s2", 0));
  const MatterScene had = world->scene();
  MatterScene absurd = had;
  absurd.viscosity_Pa_s = 2e4;
  CHECK_THROWS_AS(world->change(absurd), Error);
  CHECK(world->scene() == had);
  const DVec3 given = world->impulses().gravity;
  run(*world, 10);
  CHECK(world->impulses().gravity == given);
  world->reset();  // keeps the last parameters
  run(*world, 10);
  CHECK(world->impulses().gravity == DVec3(0));
}

TEST_CASE_FIXTURE(OnSoft,
                  "a soft body with a changed parameter continues like one that started with it" * kMoreInFull) {
  const int steps = onCpuOrGpu(40, byTier(12, 40));
  const MatterScene soft{.matter = Matter::soft,
                         .box_mm = DVec3(60),
                         .fill_mm = {20, 24, 20},
                         .spacing_mm = 5,
                         .viscosity_Pa_s = 3,
                         .friction = 0.3};
  for (const auto& [name, value] : {std::pair{"young_Pa", 6e4},
                                    {"poisson", 0.2},
                                    {"viscosity_Pa_s", 10.0},
                                    {"friction", 0.0},
                                    {"gravity_x_m_s2", 4.0}}) {
    CAPTURE(name);
    // It stands on its floor, and slides under a sideways force.
    MatterScene begins = soft;
    begins.gravity_m_s2.z = 5;
    const MatterScene changed = with(begins, name, value);
    const auto is = make(changed, 0, nullptr, {}), becomes = make(begins, 0, nullptr, {}),
               stays = make(begins, 0, nullptr, {});
    becomes->change(changed);
    for (MatterSimulation* world : {is.get(), becomes.get(), stays.get()}) run(*world, steps);
    // The skin is equally stiff except for rounding.
    double apart = 0, moved = 0;
    for (std::size_t i = 0; i < is->particles(); ++i) {
      const Vec3 place = is->positionsById()[i];
      apart = std::max(apart, double(glm::length(place - becomes->positionsById()[i])));
      moved = std::max(moved, double(glm::length(place - stays->positionsById()[i])));
    }
    CHECK(apart < 1e-7);
    CHECK(moved > 3e-7);
  }
}

}  // namespace palpate::parameter_truths_test
