#include "engine/matter/scene_settings.hpp"

namespace palpate {

namespace {

using Scene = MatterScene;

constexpr double kMaxBox_mm = 1e6;

constexpr SceneSetting kSettings[]{
    {.setting = {"matter", words<&Scene::matter, kMatters>(), "", "kind of matter"}, .required = true},
    {.setting = {"box_mm", &Scene::box_mm, "", "inner size of the box, mm", "mm", {0.01, kMaxBox_mm}},
     .required = true},
    {.setting = {"fill_mm",
                 &Scene::fill_mm,
                 "",
                 "size of the initial fill; of a soft body, the size into which it is fitted, mm",
                 "mm",
                 {0, kMaxBox_mm}},
     .required = true},
    {.setting = {"fill_at_mm", &Scene::fill_at_mm, "", "corner of the fill, mm", "mm", {0, kMaxBox_mm}},
     .ofSoft = false},
    SceneSetting{
        .setting =
            {"spacing_mm", &Scene::spacing_mm, "", "spacing of particles or nodes at rest, mm", "mm", {0.01, 1e4}},
        .required = true},
    SceneSetting{
        .setting = {"density_kg_m3", &Scene::density_kg_m3, "", "bulk density at rest, kg/m^3", "kg/m^3", {1, 1e5}}},
    {.setting = {"viscosity_Pa_s",
                 &Scene::viscosity_Pa_s,
                 "",
                 "dynamic viscosity, Pa s (default of a soft body: 3)",
                 "Pa s",
                 {0, 1e4}},
     .ofSand = false},
    {.setting = {"cohesion_N_m", &Scene::cohesion_N_m, "", "cohesion of drops, N/m", "N/m", {0, 100}},
     .ofSand = false,
     .ofSoft = false},
    {.setting = {"friction", &Scene::friction, "", "Coulomb friction coefficient", "", {0, 10}}, .ofWater = false},
    {.setting = {"young_Pa", &Scene::young_Pa, "", "Young's modulus, Pa", "Pa", {1, 1e9}},
     .ofWater = false,
     .ofSand = false},
    {.setting = {"poisson", &Scene::poisson, "", "Poisson's ratio", "", {0, 0.49}}, .ofWater = false, .ofSand = false},
    {.setting = {"shape", words<&Scene::shape, kSoftShapes>(), "", "shape of a body without a model"},
     .ofWater = false,
     .ofSand = false},
    {.setting = {"model", &Scene::model, "", "file of a closed cloud, or builtin:NAME"}},
    {.setting = {"model_mm",
                 &Scene::model_mm,
                 "",
                 "box into which the model is scaled, mm; 0: half of the box",
                 "mm",
                 {0, kMaxBox_mm}},
     .ofSoft = false},
    {.setting = {"model_at_mm", &Scene::model_at_mm, "",
                 "centre of the underside of that box, mm (default: centre of the floor)", "mm"},
     .ofSoft = false},
    {.setting = {"hole_mm",
                 &Scene::hole_mm,
                 "",
                 "widest hole of the model that is closed, mm; 0: three spacings",
                 "mm",
                 {0, kMaxBox_mm}}},
    {.setting = {"pinned_mm", &Scene::pinned_mm, "", "corners of a box in which nodes are fixed, mm", "mm"},
     .ofWater = false,
     .ofSand = false},
    {.setting = {"gravity_m_s2", &Scene::gravity_m_s2, "", "gravity, m/s^2", "m/s^2", {-1000, 1000}}},
    {.setting =
         {"substeps", &Scene::substeps, "", "substeps per millisecond; 0: as many as needed", "", {0, kMaxSubsteps}}},
    {.setting = {"tool.radius_mm",
                 part<&Scene::tool, &MatterTool::radius_mm>(),
                 "",
                 "radius of the ball in the hand, mm; 0: three spacings",
                 "mm",
                 {0, kMaxBox_mm}}},
    SceneSetting{
        .setting =
            {"tool.mass_kg", part<&Scene::tool, &MatterTool::mass_kg>(), "", "mass of the ball, kg", "kg", {0, 1e6}}},
    {.setting = {"gain", &Scene::gain, "", "ratio of the felt force to the simulated one", "", {0, 1e4}}},
};

}  // namespace

std::span<const SceneSetting> sceneSettings() { return kSettings; }

MatterScene usualScene(Matter matter) {
  MatterScene scene{.matter = matter};
  if (matter == Matter::soft) scene.viscosity_Pa_s = kSoftViscosity_Pa_s;
  return scene;
}

}  // namespace palpate
