#include "engine/matter/matter_world.hpp"

#include <algorithm>

#include "engine/core/check.hpp"
#include "engine/core/processor.hpp"
#include "engine/matter/matter_rules.hpp"

namespace palpate {

namespace {

MatterParticles::Config particlesOf(const MatterScene& scene, const MatterPlan& plan, const MatterModel* model) {
  const auto spacing = static_cast<float>(plan.spacing_m);
  const MatterReach reach = reachOf(scene.matter);
  return {.box = {.size = scene.box_mm * 1e-3, .periodic = scene.periodic},
          .nearest_m = reach.wall_spacings * spacing,
          .reach_m = reach.neighbour_spacings * spacing,
          .listed_m = (reach.neighbour_spacings + kListedFarther_spacings) * spacing,
          .mass_kg = static_cast<float>(plan.mass_kg),
          .step_s = static_cast<float>(plan.substep_s),
          .model = model};
}

}  // namespace

std::unique_ptr<MatterLaw> lawOf(const MatterScene& scene, const MatterPlan& plan) {
  return scene.matter == Matter::sand ? sandLaw(scene, plan) : waterLaw(scene, plan);
}

MatterWorld::MatterWorld(const MatterScene& scene, const MatterOptions& options)
    : MatterWorld(scene, options, placesAtRest(scene, onMachine(options, hostMemory_bytes()).memory_bytes)) {}

MatterWorld::MatterWorld(const MatterScene& scene, const MatterOptions& options, std::vector<Vec3> places)
    : MatterSimulation(scene, options, std::move(places)),
      team_(options.threads),
      tools_(options.tools, ToolBody(toolSpring(scene.tool, plan().substep_s))),
      bodies_(options.tools, ballBody(scene, plan())),
      sums_(blocksOf(beginning().size())) {
  reset();
}

MatterWorld::~MatterWorld() = default;

void MatterWorld::begin() {
  law_ = lawOf(scene(), plan());  // new, as a law stores contacts
  particles_ = std::make_unique<MatterParticles>(particlesOf(scene(), plan(), model()), beginning());
}

void MatterWorld::takeParameters() {
  law_->change(scene(), plan());
  particles_->setStep(static_cast<float>(plan().substep_s));
  for (ToolBody& tool : tools_) tool.setSpring(toolSpring(scene().tool, plan().substep_s));
}

void MatterWorld::placeToolAt(std::size_t tool, const HandPose& hand) { tools_[tool].placeAt(hand); }

MatterSimulation::StepReport MatterWorld::run(std::span<const HandPose> from, std::span<const HandPose> to) {
  WorkerTeam::Burst burst(team_);
  burst.engage(blocksOf(particles_->size()));
  StepReport report{.totals = totals()};
  for (std::uint32_t s = 0; s < plan().substeps && report.state == MatterState::running; ++s) {
    for (std::size_t k = 0; k < tools_.size(); ++k) {
      tools_[k].predict(between(from[k], to[k], (s + 1.0) / plan().substeps));
      if (model() != nullptr) tools_[k].stopAt(*model(), std::min(scene().tool.radius_mm * 1e-3, grown_m(k)));
      bodies_[k].moveTo(tools_[k].motion(), grown_m(k));
    }
    report.state = substep(report);
  }
  for (ToolBody& tool : tools_) report.tools.push_back(tool.takeReport());
  return report;
}

MatterState MatterWorld::substep(StepReport& report) {
  if (!particles_->predict(Vec3(scene().gravity_m_s2 * plan().substep_s), team_)) return MatterState::crowded;
  for (BlockSums& sums : sums_) sums = {.bodies = std::vector<Exchange>(bodies_.size())};
  law_->solve(*particles_, bodies_, sums_, team_);
  report.totals = reactTo(sums_, report);
  report.gravity += gravityOf(1);
  return report.totals.kinetic_J <= plan().mostKinetic_J(particles_->size()) ? MatterState::running
                                                                             : MatterState::diverged;
}

MatterTotals MatterWorld::reactTo(const std::vector<BlockSums>& blocks, StepReport& report) {
  MatterTotals totals;
  std::vector<Exchange> exchanges(tools_.size());
  for (const BlockSums& sums : blocks) {
    report.onWalls += sums.wallImpulse;
    report.onModel += sums.model.impulse;
    report.turnOfModel += sums.model.angular;
    totals.momentum += sums.momentum;
    totals.kinetic_J += sums.kinetic_J;
    totals.maxCompression = std::max(totals.maxCompression, static_cast<double>(sums.mostCompression));
    for (std::size_t k = 0; k < exchanges.size(); ++k) {
      exchanges[k].impulse += sums.bodies[k].impulse;
      exchanges[k].angular += sums.bodies[k].angular;
    }
  }
  for (std::size_t k = 0; k < tools_.size(); ++k) tools_[k].react(exchanges[k]);
  return totals;
}

std::vector<Vec4> MatterWorld::pressedPlaces() const {
  const std::span<const Vec4> places = std::as_const(*particles_).pressed();
  return {places.begin(), places.end()};
}

std::vector<Vec3> MatterWorld::positionsById() const {
  std::vector<Vec3> positions(particles_->size());
  for (std::size_t i = 0; i < positions.size(); ++i) positions[particles_->ids()[i]] = particles_->positions()[i];
  return positions;
}

std::vector<Vec3> MatterWorld::velocitiesById() const {
  std::vector<Vec3> velocities(particles_->size());
  for (std::size_t i = 0; i < velocities.size(); ++i)
    velocities[particles_->ids()[i]] = Vec3(particles_->velocities()[i]);
  return velocities;
}

void MatterWorld::setVelocities(std::span<const Vec3> byId) {
  PALPATE_CHECK_EQ(byId.size(), particles_->size());
  for (std::size_t i = 0; i < byId.size(); ++i) particles_->setVelocity(i, byId[particles_->ids()[i]]);
}

}  // namespace palpate
