#include "engine/matter/matter_simulation.hpp"

#include <algorithm>

#include "engine/core/check.hpp"
#include "engine/core/error.hpp"
#include "engine/core/processor.hpp"
#include "engine/matter/matter_parameters.hpp"
#include "engine/matter/matter_pressure.hpp"
#include "engine/matter/matter_rules.hpp"
#include "engine/matter/tool_body.hpp"

namespace palpate {

namespace {

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
