#include "engine/matter/matter_world.hpp"

#include <algorithm>
#include <cmath>

#include "engine/core/check.hpp"
#include "engine/matter/matter_rules.hpp"
#include "shaders/shared/weight.h"

namespace palpate {

namespace {

MatterParticles::Config particlesOf(const MatterScene& scene, const MatterPlan& plan, const MatterReach& reach) {
  const auto spacing = static_cast<float>(plan.spacing_m);
  return {.box = {.size = scene.box_mm * 1e-3, .periodic = scene.periodic},
          .nearest_m = reach.wall_spacings * spacing,
          .reach_m = reach.neighbour_spacings * spacing,
          .listed_m = (reach.neighbour_spacings + kListedFarther_spacings) * spacing,
          .mass_kg = static_cast<float>(plan.mass_kg),
          .step_s = static_cast<float>(plan.substep_s)};
}

std::vector<Vec3> insideOf(std::vector<Vec3> places, const MatterScene& scene, double spacing_m) {
  const Vec3 size(scene.box_mm * 1e-3);
  const Vec3 nearest(spacing_m / 2);
  for (Vec3& place : places) place = glm::clamp(place, nearest, glm::max(size - nearest, nearest));
  return places;
}

}  // namespace

MatterWorld::MatterWorld(const MatterScene& scene, const MatterOptions& options)
    : MatterWorld(scene, options, placesAtRest(scene)) {}

MatterWorld::MatterWorld(const MatterScene& scene, const MatterOptions& options, std::vector<Vec3> places)
    : scene_(scene),
      plan_(planOf(scene, options.memory_bytes)),
      beginning_(insideOf(std::move(places), scene, plan_.spacing_m)),
      team_(options.threads),
      law_(lawOf(scene_, plan_)) {
  PALPATE_CHECK(scene.matter != Matter::soft);
  PALPATE_CHECK(options.tools == 0 || scene.tool.radius_mm > 0);
  const auto support = static_cast<float>(kSupport_spacings * plan_.spacing_m);
  const auto points = ballPoints(scene.tool.radius_mm * 1e-3, plan_.spacing_m, support);
  tools_.assign(options.tools, ToolBody(scene.tool, plan_.substep_s));
  bodies_.assign(options.tools, BoundaryBody(points, support));
  reset();
}

MatterWorld::~MatterWorld() = default;

void MatterWorld::reset() {
  particles_ = std::make_unique<MatterParticles>(particlesOf(scene_, plan_, law_->reach()), beginning_);
  sums_.resize(blocksOf(particles_->size()));
  hands_.clear();
  answers_.assign(tools_.size(), {});
  total_ = {};
  impulses_ = {};
  state_ = MatterState::running;
  steps_ = 0;
}

void MatterWorld::step(std::span<const HandPose> hands) {
  PALPATE_CHECK_EQ(hands.size(), tools_.size());
  if (hands_.empty()) {
    hands_.assign(hands.begin(), hands.end());
    for (std::size_t k = 0; k < tools_.size(); ++k) tools_[k].placeAt(hands[k]);
  }
  for (std::uint32_t k = 0; k < plan_.substeps && state_ == MatterState::running; ++k)
    substep(hands_, hands, (k + 1.0) / plan_.substeps);
  for (std::size_t k = 0; k < tools_.size(); ++k) {
    answers_[k] = tools_[k].takeAnswer(kMatterStep_s);
    answers_[k].force_N *= scene_.gain;
    answers_[k].torque_Nm *= scene_.gain;
    if (state_ != MatterState::running) answers_[k] = {.place_m = hands[k].place_m};
  }
  hands_.assign(hands.begin(), hands.end());
  ++steps_;
}

void MatterWorld::substep(std::span<const HandPose> from, std::span<const HandPose> to, double share) {
  for (std::size_t k = 0; k < tools_.size(); ++k) {
    tools_[k].predict(between(from[k], to[k], share));
    bodies_[k].moveTo(tools_[k].motion());
  }
  const DVec3 fall = scene_.gravity_m_s2 * plan_.substep_s;
  if (!particles_->predict(Vec3(fall), team_)) {
    state_ = MatterState::crowded;
    return;
  }
  for (BlockSums& sums : sums_) sums = {.bodies = std::vector<Exchange>(bodies_.size())};
  law_->solve(*particles_, bodies_, sums_, team_);
  total_ = {.bodies = std::vector<Exchange>(bodies_.size())};
  for (const BlockSums& sums : sums_) {
    total_.wallImpulse += sums.wallImpulse;
    total_.momentum += sums.momentum;
    total_.kinetic_J += sums.kinetic_J;
    total_.mostCompression = std::max(total_.mostCompression, sums.mostCompression);
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
      total_.bodies[k].impulse += sums.bodies[k].impulse;
      total_.bodies[k].angular += sums.bodies[k].angular;
    }
  }
  impulses_.gravity += plan_.mass_kg * static_cast<double>(particles_->size()) * fall;
  impulses_.onWalls += total_.wallImpulse;
  for (std::size_t k = 0; k < tools_.size(); ++k) {
    tools_[k].react(total_.bodies[k]);
    impulses_.onTools += total_.bodies[k].impulse;
  }
  judge();
}

void MatterWorld::judge() {
  const double mass = plan_.mass_kg * static_cast<double>(particles_->size());
  const double most_J = mass * plan_.speedOfSound_m_s * plan_.speedOfSound_m_s / 2;
  if (!(total_.kinetic_J <= most_J)) state_ = MatterState::diverged;
}

MatterObservation MatterWorld::observe() const {
  MatterObservation seen{.time_s = time_s(),
                         .particles = particles_->size(),
                         .kinetic_J = total_.kinetic_J,
                         .momentum = total_.momentum,
                         .maxCompression = total_.mostCompression};
  for (const Vec3& place : particles_->positions()) {
    seen.potential_J -= plan_.mass_kg * glm::dot(scene_.gravity_m_s2, DVec3(place));
    seen.front_m = std::max(seen.front_m, place.x + plan_.spacing_m / 2);
  }
  return seen;
}

bool MatterWorld::isAtWall(const Vec3& place) const {
  for (int k = 0; k < 3; ++k) {
    const double away = std::min(static_cast<double>(place[k]), scene_.box_mm[k] * 1e-3 - place[k]);
    if (!scene_.periodic[static_cast<std::size_t>(k)] && away < plan_.spacing_m) return true;
  }
  return false;
}

double MatterWorld::pressureAt(const DVec3& place) const {
  constexpr double kRadius_spacings = 3, kWeightAtWall = 1e-4, kLeastSlope = 1e-4;
  const double radius = kRadius_spacings * plan_.spacing_m, gravity = glm::length(scene_.gravity_m_s2);
  const Vec3 down = gravity > 0 ? scene_.gravity_m_s2 / gravity : DVec3(0);
  // Least squares of a constant and a slope, which is taken to be none along an axis where the particles do not tell.
  glm::dmat4 normal(0);
  DVec4 right(0);
  for (std::size_t i = 0; i < particles_->size(); ++i) {
    const Vec4 particle = particles_->places()[i];
    const DVec3 offset = DVec3(Vec3(particle)) - place;
    const double r = glm::length(offset) / radius;
    if (!(r < 1)) continue;
    const double weight = shared::wendland(r) * (isAtWall(Vec3(particle)) ? kWeightAtWall : 1);
    const DVec4 terms(1, offset / radius);
    normal += weight * glm::outerProduct(terms, terms);
    right += weight * law_->pressureOf(*particles_, i, down) * terms;
  }
  const double weights = normal[0][0];
  if (!(weights > 0)) return 0;
  for (int k = 1; k < 4; ++k) normal[k][k] += kLeastSlope * weights;
  return std::max((glm::inverse(normal) * right).x, 0.0);
}

std::vector<Vec3> MatterWorld::positionsById() const {
  std::vector<Vec3> positions(particles_->size());
  for (std::size_t i = 0; i < positions.size(); ++i) positions[particles_->ids()[i]] = particles_->positions()[i];
  return positions;
}

std::vector<Vec3> MatterWorld::velocitiesById() const {
  std::vector<Vec3> velocities(particles_->size());
  for (std::size_t i = 0; i < velocities.size(); ++i)
    velocities[particles_->ids()[i]] = std::as_const(*particles_).velocities()[i];
  return velocities;
}

}  // namespace palpate
