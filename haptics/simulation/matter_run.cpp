#include "haptics/simulation/matter_run.hpp"

#include <utility>

#include "engine/matter/matter_parameters.hpp"

namespace palpate {

namespace {

constexpr double kMmPerMetre = 1e3;

class MatterRun final : public FreeSimulation {
 public:
  explicit MatterRun(std::unique_ptr<MatterSimulation> world) : world_(std::move(world)) {}

  void step() override { world_->step(); }
  void reset() override { world_->reset(); }
  double time_s() const override { return world_->time_s(); }
  std::uint32_t substeps() const override { return world_->plan().substeps; }
  std::string failure() const override {
    if (world_->state() == MatterState::running) return {};
    return world_->state() == MatterState::diverged ? "has diverged" : "has too many particles in one place";
  }
  std::vector<SimulationParameter> parameters() const override { return parametersOf(world_->scene()); }
  void setParameter(std::string_view name, double value) override {
    MatterScene scene = world_->scene();
    palpate::setParameter(scene, name, value);
    world_->change(scene);
  }
  CloudFrame frame() override {
    CloudFrame now;
    world_->makeFrame(now);
    for (Vec3& position : now.positions) position *= static_cast<float>(kMmPerMetre);
    for (Vec3& velocity : now.velocities) velocity *= static_cast<float>(kMmPerMetre);
    now.velocities.resize(now.size(), Vec3(0));
    now.time_s = world_->time_s();
    return now;
  }
  Totals totals() const override {
    const MatterObservation seen = world_->observe();
    Totals totals{.kinetic_J = seen.kinetic_J,
                  .potential_J = seen.potential_J,
                  .momentum_kg_m_s = seen.momentum,
                  .maxCompression = seen.maxCompression,
                  .front_mm = kMmPerMetre * seen.front_m,
                  .particles = seen.particles};
    if (!world_->model()) return totals;
    totals.insideModel = world_->insideModel();
    totals.onModel_N = world_->onModel().force_N;
    return totals;
  }

 private:
  std::unique_ptr<MatterSimulation> world_;
};

}  // namespace

std::unique_ptr<FreeSimulation> runFreely(std::unique_ptr<MatterSimulation> world) {
  return std::make_unique<MatterRun>(std::move(world));
}

}  // namespace palpate
