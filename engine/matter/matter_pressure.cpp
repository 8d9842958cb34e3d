#include "engine/matter/matter_pressure.hpp"

#include <algorithm>
#include <cmath>

#include "engine/matter/matter_rules.hpp"
#include "shaders/shared/weight.h"

namespace palpate {

namespace {

constexpr double kRadius_spacings = 3;

// All particles around a position that contribute, directly or as neighbours of one that does: across a periodic border
// their nearest image.
std::vector<Vec4> particlesAbout(const MatterScene& scene, const std::vector<Vec4>& particles, const DVec3& place,
                                 double far) {
  std::vector<Vec4> about;
  for (Vec4 particle : particles) {
    for (int k = 0; k < 3; ++k) {
      const double size = scene.box_mm[k] * 1e-3;
      if (!scene.periodic[static_cast<std::size_t>(k)]) continue;
      particle[k] -= static_cast<float>(size * std::round((static_cast<double>(particle[k]) - place[k]) / size));
    }
    if (glm::length(DVec3(Vec3(particle)) - place) < far) about.push_back(particle);
  }
  return about;
}

// The virial at a particle: the momentum flux of the neighbours' pushes through a plane perpendicular to `down`, or the
// mean over all planes if that is 0. Particles at rest are in layers, which carry more or less sideways than upwards.
double pressureOf(const shared::WaterRules& rules, double density_kg_m3, const std::vector<Vec4>& about,
                  const Vec4& particle, const Vec3& down) {
  double sum = 0;
  for (const Vec4& other : about) {
    const Vec3 offset(particle - other);
    const Vec3 change =
        shared::changeByNeighbour<float>(rules, offset, shared::wendlandPull(glm::length(offset) / rules.support),
                                         shared::pressing(particle.w) + shared::pressing(other.w), Vec3(0));
    sum += static_cast<double>(down == Vec3(0) ? glm::dot(change, offset) / 3
                                               : glm::dot(change, down) * glm::dot(offset, down));
  }
  return density_kg_m3 * (1 + static_cast<double>(shared::pressing(particle.w))) * sum /
         (2 * static_cast<double>(rules.step));
}

bool isAtWall(const MatterScene& scene, const Vec3& place) {
  for (int k = 0; k < 3; ++k) {
    const double away_mm = std::min(1e3 * static_cast<double>(place[k]), scene.box_mm[k] - 1e3 * place[k]);
    if (!scene.periodic[static_cast<std::size_t>(k)] && away_mm < particleSpacing_mm(scene)) return true;
  }
  return false;
}

}  // namespace

double waterPressure(const MatterScene& scene, const MatterPlan& plan, const std::vector<Vec4>& particles,
                     const DVec3& place) {
  constexpr double kWeightAtWall = 1e-4, kMinSlope = 1e-4;
  const shared::WaterRules rules = waterRules(scene, plan);
  const double radius = kRadius_spacings * plan.spacing_m, gravity = glm::length(scene.gravity_m_s2);
  const Vec3 down = gravity > 0 ? scene.gravity_m_s2 / gravity : DVec3(0);
  const auto about = particlesAbout(scene, particles, place, (kRadius_spacings + kSupport_spacings) * plan.spacing_m);
  // Least-squares fit of a constant and a slope; the slope is 0 along an axis that the particles do not determine.
  glm::dmat4 normal(0);
  DVec4 right(0);
  for (const Vec4& particle : about) {
    const DVec3 offset = DVec3(Vec3(particle)) - place;
    const double r = glm::length(offset) / radius;
    if (!(r < 1)) continue;
    const double weight = shared::wendland(r) * (isAtWall(scene, Vec3(particle)) ? kWeightAtWall : 1);
    const DVec4 terms(1, offset / radius);
    normal += weight * glm::outerProduct(terms, terms);
    right += weight * pressureOf(rules, scene.density_kg_m3, about, particle, down) * terms;
  }
  const double weights = normal[0][0];
  if (!(weights > 0)) return 0;
  for (int k = 1; k < 4; ++k) normal[k][k] += kMinSlope * weights;
  return std::max((glm::inverse(normal) * right).x, 0.0);
}

}  // namespace palpate
