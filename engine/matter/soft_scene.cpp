#include "engine/matter/soft_scene.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/core/error.hpp"
#include "engine/matter/matter_bounds.hpp"

namespace palpate {

namespace {

constexpr double kBytesOfSoftNode = 400;  // including its cell
constexpr double kBytesOfSoftCell = 60;   // cell of the box around the body, while it is filled
constexpr double kMaxNodes = 1 << 27;     // limit of the corners' node numbers

void requireShape(const MatterScene& scene) {
  requireBetween("fill_mm", scene.fill_mm, scene.spacing_mm, scene.box_mm);
  if (!scene.model.empty() && scene.shape != SoftShape::box) throw Error("shape: cannot be combined with a model");
  if (scene.shape == SoftShape::ball &&
      !(std::min({scene.fill_mm.x, scene.fill_mm.y, scene.fill_mm.z}) >= 2 * scene.spacing_mm))
    throw Error("fill_mm: is {:g} on its shortest side; a ball must be at least two spacings wide",
                std::min({scene.fill_mm.x, scene.fill_mm.y, scene.fill_mm.z}));
  if (!scene.pinned_mm) return;
  const auto& [low, high] = *scene.pinned_mm;
  for (int k = 0; k < 3; ++k)
    if (!(low[k] <= high[k]))
      throw Error("pinned_mm: begins at {} along {}, but ends at {}", low[k], "xyz"[k], high[k]);
}

// Maximum mass of the nodes that the ball may touch, relative to its own: half of the ball's surface, to the middle of
// the first cells.
double touchedShare(const MatterScene& scene) {
  if (scene.tool.radius_mm == 0) return 0;
  const double radius = scene.tool.radius_mm * 1e-3;
  return 3.14159265358979 * radius * radius * scene.spacing_mm * 1e-3 * scene.density_kg_m3 / scene.tool.mass_kg;
}

}  // namespace

SoftMaterial materialOf(const MatterScene& scene) {
  return {.young_Pa = scene.young_Pa,
          .poisson = scene.poisson,
          .density_kg_m3 = scene.density_kg_m3,
          .viscosity_Pa_s = scene.viscosity_Pa_s};
}

double halfSpaceCompliance_m_N(const MatterScene& scene, double radius_m) {
  return 16 * (1 - scene.poisson * scene.poisson) /
         (3 * std::numbers::pi * std::numbers::pi * scene.young_Pa * radius_m);
}

std::uint32_t substepsOf(const MatterScene& scene, const MatterPlan& plan, double stiffer) {
  if (!(stiffer > 1)) return plan.substeps;
  const auto longest = [&](double times) {
    return longestSubstep(materialOf(scene), plan.spacing_m, touchedShare(scene), times);
  };
  return static_cast<std::uint32_t>(std::ceil(plan.substeps * longest(1) / longest(stiffer) - 1e-9));
}

MatterPlan softPlanOf(const MatterScene& scene, std::uint64_t memory_bytes) {
  requireShape(scene);
  MatterPlan plan{.spacing_m = scene.spacing_mm * 1e-3};
  double cells = 1, nodes = 1;
  for (int k = 0; k < 3; ++k) {
    const double along = std::max(1.0, std::round(scene.fill_mm[k] / scene.spacing_mm));
    plan.lattice[k] = static_cast<std::uint32_t>(std::min(along, 4e9));
    cells *= along;
    nodes *= along + 1;
  }
  plan.particles = static_cast<std::uint64_t>(std::min(nodes, 1e18));
  plan.bytes = static_cast<std::uint64_t>(std::min(nodes * kBytesOfSoftNode + cells * kBytesOfSoftCell, 1e18));
  if (nodes > kMaxNodes)
    throw Error("spacing_mm: makes {} nodes, {:.0f} at most; use a larger one", plan.particles, kMaxNodes);
  if (plan.bytes > memory_bytes)
    throw Error("spacing_mm: makes {} nodes, which take about {} MiB of {}; use a larger one", plan.particles,
                plan.bytes >> 20, memory_bytes >> 20);
  const SoftMaterial material = materialOf(scene);
  const double longest_s = longestSubstep(material, plan.spacing_m, touchedShare(scene));
  const double needed = std::ceil(kMatterStep_s / longest_s - 1e-9);
  requireSubsteps(scene, needed, "a softer body or less viscosity");
  plan.substeps = scene.substeps != 0 ? scene.substeps : static_cast<std::uint32_t>(needed);
  plan.substep_s = kMatterStep_s / plan.substeps;
  plan.mass_kg = scene.density_kg_m3 * std::pow(plan.spacing_m, 3);
  plan.speedOfSound_m_s = std::sqrt((material.bulk_Pa() + 4.0 / 3 * material.shear_Pa()) / material.density_kg_m3);
  return plan;
}

PlaceBox standOf(const MatterScene& scene) {
  const DVec3 spare = scene.box_mm - scene.fill_mm;
  const DVec3 low = DVec3(spare.x / 2, 0, spare.z / 2) * 1e-3;
  return {.low = low, .high = low + scene.fill_mm * 1e-3};
}

SoftBall ballOf(const MatterScene& scene) {
  const auto [low, high] = standOf(scene);
  const DVec3 size = high - low;
  const double radius = std::min({size.x, size.y, size.z}) / 2;
  return {.middle = {low.x + size.x / 2, radius, low.z + size.z / 2}, .radius = radius};
}

std::vector<PlaceBox> pinsOf(const MatterScene& scene) {
  if (!scene.pinned_mm) return {};
  const double slack_m = 1e-6 * scene.spacing_mm;
  return {{.low = (*scene.pinned_mm)[0] * 1e-3 - slack_m, .high = (*scene.pinned_mm)[1] * 1e-3 + slack_m}};
}

double mostSoftKinetic_J(const MatterScene& scene, const MatterPlan& plan, double mass_kg) {
  const double fall_m2_s2 = 2 * glm::length(scene.gravity_m_s2) * glm::length(scene.box_mm) * 1e-3;
  return mass_kg * (plan.speedOfSound_m_s * plan.speedOfSound_m_s + fall_m2_s2);
}

void seeNodes(MatterObservation& seen, const MatterScene& scene, std::span<const Vec3> rest,
              std::span<const Vec3> displacements, std::span<const float> masses) {
  seen.particles = rest.size();
  for (std::size_t i = 0; i < rest.size(); ++i) {
    const DVec3 place = DVec3(rest[i]) + DVec3(displacements[i]);
    seen.potential_J -= static_cast<double>(masses[i]) * glm::dot(scene.gravity_m_s2, place);
    seen.front_m = std::max(seen.front_m, place.x);
  }
}

}  // namespace palpate
