#include "engine/matter/matter_rules.hpp"

#include <numbers>

#include "engine/core/vec.hpp"

namespace palpate {

namespace {

// Sum of the weights in a uniformly filled neighbourhood (continuum), at one particle per cube of spacing 1.
double evenSum(double support_spacings) {
  return 2 * std::numbers::pi / 21 * support_spacings * support_spacings * support_spacings;
}

// Square of the speed from the pushes of one iteration, before scaling by the moment of the weights.
double pushSpeed2(const Fluid& fluid) {
  const double speed = kStiffness * fluid.spacing_m / fluid.substep_s;
  return speed * speed;
}

}  // namespace

double distanceOfShare(double wanted) {
  double low = -1, high = 1;
  for (int i = 0; i < 61; ++i) {
    const double middle = (low + high) / 2;
    const double share = middle >= 0 ? shared::shareBeyond(middle) : 1 - shared::shareBeyond(-middle);
    (share > wanted ? low : high) = middle;
  }
  return (low + high) / 2;
}

LatticeSums latticeSums(double support_spacings) {
  LatticeSums sums;
  const int most = static_cast<int>(std::ceil(support_spacings));
  for (int z = -most; z <= most; ++z)
    for (int y = -most; y <= most; ++y)
      for (int x = -most; x <= most; ++x) {
        const double r = glm::length(DVec3(x, y, z)) / support_spacings;
        if (r >= 1) continue;
        sums.weight += shared::wendland(r);
        sums.moment += shared::wendlandPull(r) * r * r / 3;
        if (y >= 0) continue;
        sums.beyond += shared::wendland(r);
        sums.shear -= shared::wendlandPull(r) * y;
      }
  return sums;
}

shared::WaterRules waterRules(const Fluid& fluid) {
  const double support = kSupport_spacings * fluid.spacing_m;
  const LatticeSums sums = latticeSums(kSupport_spacings);
  const double even = evenSum(kSupport_spacings);
  const double push = fluid.substep_s * pushSpeed2(fluid) / sums.weight;
  const double drag = fluid.substep_s * 2 * fluid.viscosity_Pa_s / fluid.density_kg_m3 / sums.moment;
  const double atRest = distanceOfShare(sums.beyond / even);  // distance from the effective wall, in support radii
  const double layers = sums.shear * fluid.spacing_m / shared::shareInLayer(atRest);
  shared::WaterRules rules{};
  rules.support = static_cast<float>(support);
  rules.restSum = static_cast<float>(sums.weight);
  rules.wallSum = static_cast<float>(even);
  rules.wallInset = static_cast<float>(atRest - 0.5 / kSupport_spacings);
  rules.push = static_cast<float>(push / (support * support));
  rules.wallPush = static_cast<float>(push * even / support);
  rules.drag = static_cast<float>(drag / (support * support));
  rules.wallDrag = static_cast<float>(drag * layers / (support * support));
  rules.nearest = static_cast<float>(fluid.spacing_m / 2);
  rules.step = static_cast<float>(fluid.substep_s);
  rules.cohesion =
      static_cast<float>(fluid.cohesion_N_m * fluid.substep_s / (fluid.density_kg_m3 * std::pow(fluid.spacing_m, 3)));
  return rules;
}

shared::WaterRules waterRules(const MatterScene& scene, const MatterPlan& plan) {
  return waterRules(Fluid{.spacing_m = plan.spacing_m,
                          .density_kg_m3 = scene.density_kg_m3,
                          .viscosity_Pa_s = scene.viscosity_Pa_s,
                          .cohesion_N_m = scene.cohesion_N_m,
                          .substep_s = plan.substep_s});
}

shared::GrainRules grainRules(const MatterScene& scene, const MatterPlan& plan) {
  shared::GrainRules rules{};
  rules.diameter = static_cast<float>(plan.spacing_m);
  rules.share = static_cast<float>(kGrainShare);
  rules.friction = static_cast<float>(scene.friction);
  rules.step = static_cast<float>(plan.substep_s);
  return rules;
}

MatterReach reachOf(Matter matter) {
  return matter == Matter::sand ? MatterReach{.neighbour_spacings = 1, .wall_spacings = 0.25f}
                                : MatterReach{.neighbour_spacings = float{kSupport_spacings}, .wall_spacings = 0.5f};
}

}  // namespace palpate
