#include "engine/matter/matter_simulation.hpp"

#include <algorithm>
#include <cmath>

#include "engine/core/check.hpp"
#include "engine/core/error.hpp"
#include "engine/core/processor.hpp"
#include "engine/matter/matter_parameters.hpp"
#include "engine/matter/matter_rules.hpp"
#include "engine/matter/tool_body.hpp"
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

/// Pressure of water at `place`, as in MatterSimulation::pressureAt(). `particles`: m, in any order; w: the
/// compression.
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

// Particles that start within this distance of a ball are pushed out like those inside it.
constexpr double kBesideBall_spacings = 0.25;
// Growth speed of a ball's radius, as a share of the speed of sound of the matter.
constexpr double kGrowth_ofSound = 0.01;

std::vector<Vec3> insideOf(std::vector<Vec3> places, const MatterScene& scene, double spacing_m) {
  const Vec3 size(scene.box_mm * 1e-3);
  const Vec3 nearest(spacing_m / 2);
  for (Vec3& place : places) place = glm::clamp(place, nearest, glm::max(size - nearest, nearest));
  return places;
}

std::shared_ptr<const MatterModel> modelFor(const MatterScene& scene, const MatterOptions& options) {
  if (scene.matter == Matter::soft || scene.model.empty()) return nullptr;
  if (options.model) return options.model;
  if (!isBuiltInModel(scene.model)) throw Error("model: {} is a file that was not read", scene.model);
  return std::make_shared<const MatterModel>(builtInModel(scene, options.threads), scene, options.threads);
}

}  // namespace

MatterOptions onMachine(MatterOptions options, std::uint64_t machine_bytes) {
  if (options.memory_bytes == 0) options.memory_bytes = matterMemory(machine_bytes);
  return options;
}

MatterSimulation::MatterSimulation(const MatterScene& scene, const MatterOptions& options, std::vector<Vec3> places)
    : scene_(scene),
      plan_(planOf(scene, onMachine(options, hostMemory_bytes()).memory_bytes)),
      memory_bytes_(onMachine(options, hostMemory_bytes()).memory_bytes),
      model_(modelFor(scene, options)),
      beginning_(insideOf(std::move(places), scene, plan_.spacing_m)),
      balls_(options.tools),
      answers_(options.tools) {
  PALPATE_CHECK(options.tools == 0 || scene.tool.radius_mm > 0);
  if (model_) leftOut_ = leaveOut(beginning_, *model_);
}

void MatterSimulation::reset() {
  hands_.assign(tools(), {});
  for (Ball& ball : balls_) ball.waits = true;
  std::ranges::fill(answers_, ToolAnswer{});
  portEnergies_J_.assign(tools(), 0);
  totals_ = {};
  impulses_ = {};
  onModel_ = {};
  state_ = MatterState::running;
  steps_ = 0;
  begin();
}

void MatterSimulation::change(const MatterScene& scene) {
  MatterScene same = scene;
  for (const SimulationParameter& had : parametersOf(scene_)) setParameter(same, had.name, had.value);
  PALPATE_CHECK(same == scene_);
  plan_ = planOf(scene, memory_bytes_);
  scene_ = scene;
  takeParameters();
}

void MatterSimulation::step(std::span<const HandPose> hands) {
  PALPATE_CHECK_EQ(hands.size(), tools());
  placeWaiting(hands);
  growBalls();
  if (state_ == MatterState::running) take(run(hands_, hands), hands);
  if (state_ != MatterState::running) onModel_ = {};
  if (state_ != MatterState::running)
    for (std::size_t k = 0; k < tools(); ++k) answers_[k] = {.place_m = hands[k].place_m};
  hands_.assign(hands.begin(), hands.end());
  ++steps_;
}

void MatterSimulation::press(std::span<const SurfacePress> presses) { PALPATE_CHECK(presses.empty()); }

void MatterSimulation::take(const StepReport& report, std::span<const HandPose> hands) {
  state_ = report.state;
  totals_ = report.totals;
  impulses_.gravity += report.gravity;
  impulses_.onWalls += report.onWalls;
  impulses_.onModel += report.onModel;
  onModel_ = {.force_N = report.onModel / kMatterStep_s, .torque_Nm = report.turnOfModel / kMatterStep_s};
  impulses_.onTools += report.onPresses;
  for (std::size_t k = 0; k < tools(); ++k) {
    const ToolReport& tool = report.tools[k];
    impulses_.onTools += tool.impulse;
    portEnergies_J_[k] += hands[k].felt * scene_.gain * tool.portWork_J;
    answers_[k] = {.force_N = -scene_.gain * tool.springImpulse / kMatterStep_s,
                   .torque_Nm = scene_.gain * tool.angular / kMatterStep_s,
                   .reaction_N = tool.impulse / kMatterStep_s,
                   .byModel_N = tool.modelImpulse / kMatterStep_s,
                   .place_m = tool.place_m,
                   .velocity_m_s = tool.velocity_m_s,
                   .coupling_N_m = couplingStiffness_N_m(scene_)};
  }
}

void MatterSimulation::placeTool(std::size_t tool) { balls_[tool].waits = true; }

void MatterSimulation::placeWaiting(std::span<const HandPose> hands) {
  if (std::ranges::none_of(balls_, &Ball::waits)) return;
  const std::vector<Vec3> places = steps_ == 0 ? beginning_ : positionsById();
  for (std::size_t k = 0; k < balls_.size(); ++k)
    if (balls_[k].waits) place(k, hands[k], places);
}

// `places`: positions of all particles.
void MatterSimulation::place(std::size_t tool, const HandPose& hand, std::span<const Vec3> places) {
  const double within_m = scene_.tool.radius_mm * 1e-3 + kBesideBall_spacings * plan_.spacing_m;
  const auto isWithin = [&](const Vec3& place) { return glm::length(DVec3(place) - hand.place_m) < within_m; };
  const auto within = static_cast<std::size_t>(std::ranges::count_if(places, isWithin));
  balls_[tool] = {.grown_m = within > 0 ? 0 : wholeBall_m(), .pushedOut = within, .waits = false};
  hands_[tool] = hand;
  portEnergies_J_[tool] = 0;
  placeToolAt(tool, hand);
}

void MatterSimulation::growBalls() {
  for (Ball& ball : balls_)
    ball.grown_m = std::min(ball.grown_m + kGrowth_ofSound * plan_.speedOfSound_m_s * kMatterStep_s, wholeBall_m());
}

double MatterSimulation::wholeBall_m() const {
  return scene_.tool.radius_mm * 1e-3 + (kSupport_spacings + 2) * plan_.spacing_m;
}

DVec3 MatterSimulation::gravityOf(std::uint32_t substeps) const {
  const double mass_kg = plan_.mass_kg * static_cast<double>(particles());
  return mass_kg * plan_.substep_s * static_cast<double>(substeps) * scene_.gravity_m_s2;
}

std::size_t MatterSimulation::insideModel() const {
  if (!model_) return 0;
  const std::vector<Vec3> places = positionsById();
  return static_cast<std::size_t>(
      std::ranges::count_if(places, [&](const Vec3& place) { return model_->holds(place); }));
}

MatterObservation MatterSimulation::observe() const {
  MatterObservation seen{totals_};
  seen.time_s = time_s();
  seen.particles = particles();
  for (const Vec3& place : positionsById()) {
    seen.potential_J -= plan_.mass_kg * glm::dot(scene_.gravity_m_s2, DVec3(place));
    seen.front_m = std::max(seen.front_m, static_cast<double>(place.x) + plan_.spacing_m / 2);
  }
  return seen;
}

void MatterSimulation::makeFrame(CloudFrame& frame) {
  frame.time_s = time_s();
  frame.positions = positionsById();
  frame.velocities = velocitiesById();
  frame.normals.clear();
}

double MatterSimulation::pressureAt(const DVec3& place) const {
  if (scene_.matter != Matter::water) return 0;
  return waterPressure(scene_, plan_, pressedPlaces(), place);
}

}  // namespace palpate
