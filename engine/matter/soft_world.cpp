#include "engine/matter/soft_world.hpp"

#include <algorithm>

#include "engine/core/check.hpp"
#include "engine/core/processor.hpp"
#include "engine/matter/soft_scene.hpp"

namespace palpate {

namespace {

constexpr std::size_t kPointsOfBlock = 1024;

// So many take about 20 us of a substep: fewer are not worth another thread.
constexpr std::size_t kNodesOfThread = 256;

SoftContact::Config contactOf(const MatterScene& scene, const MatterPlan& plan) {
  return {.box_m = scene.box_mm * 1e-3,
          .ball_m = scene.tool.radius_mm * 1e-3,
          .frequency_rad_s = touchFrequency(materialOf(scene), plan.spacing_m),
          .friction = scene.friction};
}

std::vector<Vec3> restOf(const SoftSolid& solid) { return {solid.lattice.rest().begin(), solid.lattice.rest().end()}; }

double dotOf(std::span<const DVec3> a, std::span<const DVec3> b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += glm::dot(a[i], b[i]);
  return sum;
}

}  // namespace

SoftEmbedding::SoftEmbedding(const SoftLattice& lattice, std::span<const SurfacePlace> points)
    : rest_(points.begin(), points.end()) {
  places_.reserve(points.size());
  for (const SurfacePlace& point : points) places_.push_back(lattice.embed(DVec3(point.rest)));
}

void SoftEmbedding::carry(const SoftBody& body, CloudFrame& frame, WorkerTeam& team) {
  body.gradients(gradients_, team);
  frame.positions.resize(size());
  frame.normals.resize(size());
  frame.velocities.resize(size());
  team.forEach((size() + kPointsOfBlock - 1) / kPointsOfBlock, [&](std::size_t block) {
    const std::size_t end = std::min((block + 1) * kPointsOfBlock, size());
    for (std::size_t i = block * kPointsOfBlock; i < end; ++i) {
      const SoftLattice::Corners& nodes = body.lattice().corners()[places_[i].cell];
      Vec3 moved(0), velocity(0);
      glm::mat3 gradient(0);
      for (int k = 0; k < 8; ++k) {
        const float share = shared::cornerShare(places_[i].share, k);
        const std::uint32_t node = nodes[static_cast<std::size_t>(k)];
        moved += share * body.displacements()[node];
        velocity += share * body.velocities()[node];
        gradient += share * gradients_[node];
      }
      frame.positions[i] = rest_[i].rest + moved;
      frame.velocities[i] = velocity;
      frame.normals[i] = shared::unitNormalCarried(gradient, rest_[i].normal);
    }
  });
}

SoftWorld::SoftWorld(const MatterScene& scene, const MatterOptions& options)
    : SoftWorld(scene, options, softModelFor(scene, onMachine(options, hostMemory_bytes()))) {}

SoftWorld::SoftWorld(const MatterScene& scene, const MatterOptions& options, SoftSolid solid,
                     std::span<const SurfacePlace> points)
    : SoftWorld(scene, options, softModelOf(std::move(solid), points)) {}

SoftWorld::SoftWorld(const MatterScene& scene, const MatterOptions& options, std::shared_ptr<const SoftModel> model)
    : MatterSimulation(scene, options, restOf(model->solid)),
      team_(options.threads),
      model_(std::move(model)),
      body_(model_->solid.lattice, materialOf(scene), pinsOf(scene)),
      contact_(body_, model_->solid.surface, contactOf(scene, plan())),
      surface_(model_->solid.lattice, model_->solid.surface),
      press_(body_, surface_),
      sculpture_(body_, surface_),
      embedding_(model_->solid.lattice, model_->points),
      tools_(options.tools, ToolBody(toolSpring(scene.tool, plan().substep_s))) {
  PALPATE_CHECK(scene.matter == Matter::soft);
  reset();
}

void SoftWorld::begin() {
  sculpture_.endStroke();
  body_.reset();
  presses_.clear();
  press_.begin(body_, {}, kMatterStep_s, team_);
}

void SoftWorld::takeParameters() {
  body_.setMaterial(materialOf(scene()));
  contact_.change(contactOf(scene(), plan()));
  for (ToolBody& tool : tools_) tool.setSpring(toolSpring(scene().tool, plan().substep_s));
}

void SoftWorld::placeToolAt(std::size_t tool, const HandPose& hand) { tools_[tool].placeAt(hand); }

MatterSimulation::StepReport SoftWorld::run(std::span<const HandPose> from, std::span<const HandPose> to) {
  WorkerTeam::Burst burst(team_);
  burst.engage(body_.size() / kNodesOfThread);
  StepReport report{.totals = totals()};
  std::vector<BodyMotion> balls;
  for (const ToolBody& tool : tools_) balls.push_back(tool.motion());
  contact_.list(body_, balls, kMatterStep_s, team_);
  press_.begin(body_, presses_, kMatterStep_s, team_);
  presses_.clear();
  std::vector<HandPose> hands(tools_.size());
  const std::uint32_t substeps = substepsOf(scene(), plan(), body_.rest().stiffest());
  for (std::uint32_t s = 0; s < substeps && report.state == MatterState::running; ++s) {
    const double share = (s + 1.0) / substeps;
    for (std::size_t k = 0; k < tools_.size(); ++k) hands[k] = between(from[k], to[k], share);
    substep(hands, share, kMatterStep_s / substeps, report);
  }
  press_.end(body_);
  for (const PressReport& pressed : press_.reports()) report.onPresses += pressed.impulse;
  for (ToolBody& tool : tools_) report.tools.push_back(tool.takeReport());
  return report;
}

void SoftWorld::substep(std::span<const HandPose> hands, double share, double length_s, StepReport& report) {
  std::vector<BodyMotion> balls;
  for (std::size_t k = 0; k < tools_.size(); ++k) {
    tools_[k].predict(hands[k]);
    balls.push_back(tools_[k].motion());
  }
  std::vector<Exchange> exchanges(tools_.size());
  contact_.press(body_, balls, length_s, report.onWalls, exchanges, team_);
  body_.strain(team_);
  press_.load(body_, share, length_s, scene().gravity_m_s2);
  const SoftSums sums = body_.move(scene().gravity_m_s2, length_s, team_);
  report.gravity += sums.gravityImpulse;
  report.onWalls += sums.pinImpulse;
  report.totals = {.kinetic_J = sums.kinetic_J,
                   .momentum = sums.momentum,
                   .maxCompression = 1 - static_cast<double>(sums.leastVolume)};
  for (std::size_t k = 0; k < tools_.size(); ++k) tools_[k].react(exchanges[k]);
  if (!(sums.kinetic_J <= mostSoftKinetic_J(scene(), plan(), body_.mass_kg()))) report.state = MatterState::diverged;
}

std::vector<Vec3> SoftWorld::positionsById() const {
  std::vector<Vec3> places(body_.size());
  for (std::size_t i = 0; i < places.size(); ++i) places[i] = body_.lattice().rest()[i] + body_.displacements()[i];
  return places;
}

std::vector<Vec3> SoftWorld::velocitiesById() const { return {body_.velocities().begin(), body_.velocities().end()}; }

void SoftWorld::setVelocities(std::span<const Vec3> byId) {
  PALPATE_CHECK_EQ(byId.size(), body_.size());
  for (std::size_t i = 0; i < byId.size(); ++i) body_.velocities()[i] = body_.isPinned(i) ? Vec3(0) : byId[i];
}

MatterObservation SoftWorld::observe() const {
  MatterObservation seen{totals()};
  seen.time_s = time_s();
  seeNodes(seen, scene(), body_.lattice().rest(), body_.displacements(), body_.masses());
  return seen;
}

double SoftWorld::localCompliance_m_N(const DVec3& place_m, double radius_m, const DVec3& direction) {
  constexpr int kMaxRounds = 300;
  constexpr double kLeft = 1e-3;  // tolerance of the residual; the relative error of the compliance is its square
  std::vector<DVec3> residual = surface_.spread(body_, place_m, radius_m, direction);
  for (std::size_t i = 0; i < residual.size(); ++i)
    if (body_.isPinned(i)) residual[i] = DVec3(0);
  const std::vector<DVec3> load = residual;
  std::vector<DVec3> moved(residual.size(), DVec3(0)), way = residual, force;
  const double begin = dotOf(residual, residual);
  double left = begin;
  for (int k = 0; k < kMaxRounds && left > kLeft * kLeft * begin; ++k) {
    body_.stiffnessTimes(way, force, team_);
    contact_.addWallStiffness(body_, way, force);
    for (std::size_t i = 0; i < way.size(); ++i)
      force[i] = body_.isPinned(i) ? DVec3(0) : force[i] + kHold_1_s2 * static_cast<double>(body_.masses()[i]) * way[i];
    const double curvature = dotOf(way, force);
    if (!(curvature > 0)) break;  // it would buckle that way: it yields at least as far as until here (Steihaug 1983)
    const double far = left / curvature;
    for (std::size_t i = 0; i < way.size(); ++i) {
      moved[i] += far * way[i];
      residual[i] -= far * force[i];
    }
    const double before = left;
    left = dotOf(residual, residual);
    for (std::size_t i = 0; i < way.size(); ++i) way[i] = residual[i] + left / before * way[i];
  }
  return dotOf(load, moved);
}

void SoftWorld::makeFrame(CloudFrame& frame) {
  embedding_.carry(body_, frame, team_);
  frame.time_s = time_s();
}

}  // namespace palpate
