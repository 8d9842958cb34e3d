#include "engine/matter/matter_scene.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/core/error.hpp"
#include "engine/core/named_values.hpp"
#include "engine/core/unknown_name.hpp"
#include "engine/matter/matter_bounds.hpp"
#include "engine/matter/matter_rules.hpp"
#include "engine/matter/scene_settings.hpp"
#include "engine/matter/soft_scene.hpp"

namespace palpate {

namespace {

constexpr double kMaxCells = 64e6;         // cells of the grid, whose memory grows with the box
constexpr double kBytesOfParticle = 1600;  // including its neighbours
constexpr double kBytesOfCell = 4;
constexpr double kBytesOfNode = 200;  // node of the field around a model, during its construction
constexpr double kMinModel_spacings = 4;
constexpr std::uint64_t kMaxParticles = 1 << 27;  // limit of the neighbours' slot numbers
// Maximum displacement in a substep of a particle that falls through the whole box.
constexpr double kMaxWay_spacings = 0.5;

void requireFields(const MatterScene& scene) {
  forEachBounded(sceneSettings(), scene, [](const Setting<MatterScene>& setting, double value) {
    requireBetween(setting.name, value, setting.range.min, setting.range.max);
  });
  for (int k = 0; k < 3; ++k)
    if (!(scene.box_mm[k] >= scene.spacing_mm))
      throw Error("box_mm: is {}; it must be at least the spacing, {}", scene.box_mm[k], scene.spacing_mm);
  for (int k = 0; k < 3; ++k)
    if (!(scene.fill_mm[k] <= scene.box_mm[k]))
      throw Error("fill_mm: is {} along {}, where the box is {}", scene.fill_mm[k], "xyz"[k], scene.box_mm[k]);
  for (int k = 0; k < 3; ++k)
    if (!(scene.fill_at_mm[k] + scene.fill_mm[k] <= scene.box_mm[k] * (1 + 1e-9)))
      throw Error("fill_at_mm: puts the fill up to {:g} along {}, where the box is {:g}",
                  scene.fill_at_mm[k] + scene.fill_mm[k], "xyz"[k], scene.box_mm[k]);
}

double displaced_kg(const MatterScene& scene, double radius_mm) {
  return scene.density_kg_m3 * 4 / 3 * std::numbers::pi * std::pow(radius_mm * 1e-3, 3);
}

void requireTool(const MatterScene& scene) {
  const auto& [radius, mass] = scene.tool;
  if (radius == 0) return;
  if (radius < scene.spacing_mm)
    throw Error("tool.radius_mm: is {}; it must be at least the spacing, {}", radius, scene.spacing_mm);
  const double smallest = std::min({scene.box_mm.x, scene.box_mm.y, scene.box_mm.z});
  if (2 * radius >= smallest)
    throw Error("tool.radius_mm: is {}; twice that must be less than the box, {}", radius, smallest);
  const double displaced = displaced_kg(scene, radius);
  if (mass < displaced / 2)
    throw Error("tool.mass_kg: is {}; it must be at least {:.3g}, half of the displaced mass", mass, displaced / 2);
}

// Number of nodes of the field around a model: half a spacing apart, some spacings beyond the model.
double nodesOfModel(const MatterScene& scene) {
  if (scene.model.empty()) return 0;
  const auto [low, high] = modelBox_mm(scene);
  const DVec3 nodes = 2.0 * (high - low + 2.0 * scene.tool.radius_mm) / particleSpacing_mm(scene) + 14.0;
  return nodes.x * nodes.y * nodes.z;
}

void requireModel(const MatterScene& scene) {
  if (scene.model.empty()) {
    if (scene.model_mm != DVec3(0) || scene.model_at_mm)
      throw Error("model: is missing, but model_mm or model_at_mm is given");
    return;
  }
  if (scene.model_mm != DVec3(0)) requireBetween("model_mm", scene.model_mm, scene.spacing_mm, scene.box_mm);
  const auto [low, high] = modelBox_mm(scene);
  const DVec3 sides = high - low;
  if (const double longest = std::max({sides.x, sides.y, sides.z}); longest < kMinModel_spacings * scene.spacing_mm)
    throw Error("model_mm: is {:g} on its longest side, which must be at least {:g} spacings; use a smaller spacing_mm",
                longest, kMinModel_spacings);
  for (int k = 0; k < 3; ++k)
    if (!(low[k] >= 0 && high[k] <= scene.box_mm[k] * (1 + 1e-9)))
      throw Error("model_at_mm: puts the model from {:g} to {:g} along {}, where the box is {:g}", low[k], high[k],
                  "xyz"[k], scene.box_mm[k]);
}

// Longest substep at which the grains at the bottom of the fill overlap by no more than a fiftieth of their diameter,
// with one contact above and one below.
double grainSubstep(const MatterScene& scene, double spacing_m) {
  const double drop = std::abs(glm::dot(scene.gravity_m_s2, (scene.fill_at_mm + scene.fill_mm) * 1e-3));
  return drop > 0 ? std::sqrt(0.02 * kGrainShare / drop) * spacing_m : kMatterStep_s;
}

// Speed of sound that limits the compression: to a two-hundredth at rest, and to that of matter that has fallen by its
// own height; likewise inside a drop with a radius of three spacings, with the cohesion as surface tension.
double neededSpeedOfSound(const MatterScene& scene, double spacing_m) {
  constexpr double kSmallestDrop_spacings = 3;
  const double fall = std::abs(glm::dot(scene.gravity_m_s2, (scene.fill_at_mm + scene.fill_mm) * 1e-3));
  const double inDrop = 2 * scene.cohesion_N_m / (scene.density_kg_m3 * kSmallestDrop_spacings * spacing_m);
  return std::sqrt(200 * (fall + inDrop));
}

// Substeps per step, as a real number.
double neededSubsteps(const MatterScene& scene, double spacing_m) {
  const double bySound = scene.matter == Matter::sand
                             ? kMatterStep_s / grainSubstep(scene, spacing_m)
                             : kMatterStep_s * neededSpeedOfSound(scene, spacing_m) / (kStiffness * spacing_m);
  const double fall_m_s = std::sqrt(2 * glm::length(scene.gravity_m_s2) * glm::length(scene.box_mm) * 1e-3);
  const double byFall = kMatterStep_s * fall_m_s / (kMaxWay_spacings * spacing_m);
  const double viscosity_m2_s = scene.matter == Matter::water ? scene.viscosity_Pa_s / scene.density_kg_m3 : 0;
  const double byViscosity = kMatterStep_s * viscosity_m2_s / (kMaxDiffusion * spacing_m * spacing_m);
  return std::max({1.0, bySound, byFall, byViscosity});
}

void requireMemory(const MatterPlan& plan, double cells, std::uint64_t memory_bytes) {
  if (cells > kMaxCells)
    throw Error("spacing_mm: is so small that the box has {:.3g} cells, {:g} at most; use a larger one", cells,
                kMaxCells);
  if (plan.particles > kMaxParticles)
    throw Error("spacing_mm: makes {} particles, {} at most; use a larger one", plan.particles, kMaxParticles);
  if (plan.bytes > memory_bytes)
    throw Error("spacing_mm: makes {} particles, which take about {} MiB of {}; use a larger one", plan.particles,
                plan.bytes >> 20, memory_bytes >> 20);
}

}  // namespace

std::array<DVec3, 2> modelBox_mm(const MatterScene& scene) {
  const DVec3 sides = scene.model_mm == DVec3(0) ? scene.box_mm / 2.0 : scene.model_mm;
  const DVec3 at = scene.model_at_mm.value_or(DVec3(scene.box_mm.x, 0, scene.box_mm.z) / 2.0);
  const DVec3 low = at - DVec3(sides.x, 0, sides.z) / 2.0;
  return {low, low + sides};
}

MatterTool usualTool(const MatterScene& scene) {
  constexpr double kRadius_spacings = 3, kMaxOfBox = 0.4;
  const double narrowest_mm = std::min({scene.box_mm.x, scene.box_mm.y, scene.box_mm.z});
  const double radius_mm = std::min(kRadius_spacings * scene.spacing_mm, kMaxOfBox * narrowest_mm);
  return {.radius_mm = radius_mm, .mass_kg = displaced_kg(scene, radius_mm)};
}

namespace {

// Layers of the fill along an axis: the fewest that are at most as far apart as the scene's spacing.
double layersAlong(const MatterScene& scene, int axis) {
  return std::ceil(scene.fill_mm[axis] / scene.spacing_mm - 1e-6);
}

}  // namespace

double particleSpacing_mm(const MatterScene& scene) {
  constexpr double kSame = 1e-6;
  if (scene.matter == Matter::soft) return scene.spacing_mm;
  double cubed = 1;
  for (int k = 0; k < 3; ++k) cubed *= scene.fill_mm[k] / std::max(1.0, layersAlong(scene, k));
  const double spacing_mm = std::cbrt(cubed);
  return spacing_mm > 0 && spacing_mm < (1 - kSame) * scene.spacing_mm ? spacing_mm : scene.spacing_mm;
}

MatterPlan planOf(const MatterScene& scene, std::uint64_t memory_bytes) {
  requireFields(scene);
  requireTool(scene);
  if (scene.matter == Matter::soft) return softPlanOf(scene, memory_bytes);
  requireModel(scene);
  const double spacing_mm = particleSpacing_mm(scene);
  MatterPlan plan{.spacing_m = spacing_mm * 1e-3};
  double particles = 1, cells = 1;
  for (int k = 0; k < 3; ++k) {
    plan.lattice[k] = static_cast<std::uint32_t>(std::min(layersAlong(scene, k), 4e9));
    const double apart_mm = scene.fill_mm[k] / std::max(1U, plan.lattice[k]);
    plan.apart_m[k] = (spacing_mm == scene.spacing_mm ? spacing_mm : apart_mm) * 1e-3;
    particles *= plan.lattice[k];
    cells *= std::max(1.0, std::floor(scene.box_mm[k] / spacing_mm / (kReach_spacings / 2)));
    if (scene.periodic[k] && scene.box_mm[k] < 3 * kReach_spacings * scene.spacing_mm)
      throw Error("box_mm: is {} along {}, where it is periodic and must be at least {} spacings", scene.box_mm[k],
                  "xyz"[k], 3 * kReach_spacings);
  }
  plan.particles = static_cast<std::uint64_t>(std::min(particles, 1e18));
  plan.bytes = static_cast<std::uint64_t>(
      std::min(particles * kBytesOfParticle + cells * kBytesOfCell + nodesOfModel(scene) * kBytesOfNode, 1e18));
  requireMemory(plan, cells, memory_bytes);
  const double needed = std::ceil(neededSubsteps(scene, plan.spacing_m) - 1e-9);
  requireSubsteps(scene, needed, "less viscosity or less gravity");
  plan.substeps = scene.substeps != 0 ? scene.substeps : static_cast<std::uint32_t>(needed);
  plan.substep_s = kMatterStep_s / plan.substeps;
  plan.mass_kg = scene.density_kg_m3 * plan.spacing_m * plan.spacing_m * plan.spacing_m;
  plan.speedOfSound_m_s = kStiffness * plan.spacing_m / plan.substep_s;
  return plan;
}

namespace {

// Grains exactly above each other would have no direction to fall: each is displaced by at most this much along each
// axis, pseudo-randomly from its number.
constexpr float kUneven_spacings = 0.15f;

Vec3 unevenness(std::uint32_t number) {
  Vec3 moved;
  for (int axis = 0; axis < 3; ++axis) {
    std::uint32_t bits = 3 * number + static_cast<std::uint32_t>(axis);
    // The finalizer of MurmurHash3 (Appleby), which spreads neighbouring numbers.
    bits = (bits ^ bits >> 16) * 0x85ebca6bu;
    bits = (bits ^ bits >> 13) * 0xc2b2ae35u;
    bits ^= bits >> 16;
    moved[axis] = kUneven_spacings * (static_cast<float>(bits >> 8) / 0x1p23f - 1.0f);
  }
  return moved;
}

}  // namespace

std::vector<Vec3> placesAtRest(const MatterScene& scene, std::uint64_t memory_bytes) {
  const MatterPlan plan = planOf(scene, memory_bytes);
  std::vector<Vec3> places;
  places.reserve(plan.particles);
  for (std::uint32_t z = 0; z < plan.lattice.z; ++z)
    for (std::uint32_t y = 0; y < plan.lattice.y; ++y)
      for (std::uint32_t x = 0; x < plan.lattice.x; ++x)
        places.emplace_back(scene.fill_at_mm * 1e-3 + (DVec3(x, y, z) + 0.5) * plan.apart_m);
  if (scene.matter == Matter::sand)
    for (std::size_t i = 0; i < places.size(); ++i)
      places[i] += static_cast<float>(plan.spacing_m) * unevenness(static_cast<std::uint32_t>(i));
  return places;
}

namespace {

const std::vector<std::pair<std::string_view, MatterScene>>& builtInScenes() {
  static const std::vector<std::pair<std::string_view, MatterScene>> scenes{
      {"water", {.box_mm = {170, 200, 170}, .fill_mm = {170, 170, 170}, .spacing_mm = 10}},
      {"dam", {.box_mm = {600, 300, 50}, .fill_mm = {100, 200, 50}, .spacing_mm = 10}},
      {"sand",
       {.matter = Matter::sand,
        .box_mm = {300, 150, 150},
        .fill_mm = {100, 100, 150},
        .spacing_mm = 10,
        .density_kg_m3 = 1600}},
      {"statue in water",
       {.box_mm = {200, 180, 200},
        .fill_mm = {200, 60, 200},
        .spacing_mm = 10,
        .model = "builtin:sculpture",
        .model_mm = {120, 120, 120}}},
      {"drop",
       {.box_mm = {48, 48, 48},
        .fill_mm = {16, 16, 16},
        .fill_at_mm = {16, 16, 16},
        .spacing_mm = 1,
        .cohesion_N_m = 0.0728,
        .gravity_m_s2 = {0, 0, 0},
        .tool = {.radius_mm = 3, .mass_kg = 1.2e-4},
        .gain = 100}},
      {"jelly",
       {.matter = Matter::soft,
        .box_mm = {160, 120, 160},
        .fill_mm = {80, 60, 80},
        .spacing_mm = 6,
        .viscosity_Pa_s = kSoftViscosity_Pa_s,
        .tool = {.radius_mm = 15, .mass_kg = 0.05}}},
      {"soft statue",
       {.matter = Matter::soft,
        .box_mm = {200, 160, 200},
        .fill_mm = {120, 120, 120},
        .spacing_mm = 4,
        .viscosity_Pa_s = 10,
        .young_Pa = 1e5,
        .poisson = 0.3,
        .shape = SoftShape::sculpture}}};
  return scenes;
}

}  // namespace

std::vector<std::string_view> matterSceneNames() {
  std::vector<std::string_view> names;
  for (const auto& [name, scene] : builtInScenes()) names.push_back(name);
  return names;
}

MatterScene matterSceneNamed(std::string_view name) {
  if (const auto scene = valueNamed(builtInScenes(), name)) return *scene;
  throw Error("{}", unknownName("scene", name, matterSceneNames()));
}

}  // namespace palpate
