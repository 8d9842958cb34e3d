// Matter on the CPU.
#pragma once

#include <memory>
#include <span>

#include "engine/core/worker_team.hpp"
#include "engine/matter/boundary.hpp"
#include "engine/matter/matter_particles.hpp"
#include "engine/matter/matter_scene.hpp"
#include "engine/matter/matter_simulation.hpp"
#include "engine/matter/tool_body.hpp"

namespace palpate {

/// Interaction of the particles of a kind of matter with each other, walls and bodies: the interface of the kinds.
class MatterLaw {
 public:
  virtual ~MatterLaw() = default;

  /// Sets the parameters; stored state is kept.
  virtual void change(const MatterScene& scene, const MatterPlan& plan) = 0;
  /// Moves particles from the predicted positions to the final ones of the substep: settles each slot once. `sums`: one
  /// per block, zeroed, with an exchange for each body.
  virtual void solve(MatterParticles& particles, std::span<const BoundaryBody> bodies, std::span<BlockSums> sums,
                     WorkerTeam& team) = 0;
};

/// A new kind of matter requires a file and a line here.
std::unique_ptr<MatterLaw> waterLaw(const MatterScene& scene, const MatterPlan& plan);
std::unique_ptr<MatterLaw> sandLaw(const MatterScene& scene, const MatterPlan& plan);
std::unique_ptr<MatterLaw> lawOf(const MatterScene& scene, const MatterPlan& plan);

/// The results are bitwise identical for any number of threads.
class MatterWorld final : public MatterSimulation {
 public:
  /// Throws Error as planOf() does.
  explicit MatterWorld(const MatterScene& scene, const MatterOptions& options = {});
  /// The same with other initial positions than at rest in the fill, m; those outside the box are clamped to its walls.
  MatterWorld(const MatterScene& scene, const MatterOptions& options, std::vector<Vec3> places);
  ~MatterWorld() override;

  std::optional<double> gpuTime_us() const override { return std::nullopt; }
  std::vector<Vec3> positionsById() const override;
  std::vector<Vec3> velocitiesById() const override;
  void setVelocities(std::span<const Vec3> byId) override;

 private:
  void begin() override;
  void placeToolAt(std::size_t tool, const HandPose& hand) override;
  StepReport run(std::span<const HandPose> from, std::span<const HandPose> to) override;
  void takeParameters() override;
  std::vector<Vec4> pressedPlaces() const override;

  MatterState substep(StepReport& report);
  MatterTotals reactTo(const std::vector<BlockSums>& sums, StepReport& report);

  WorkerTeam team_;
  std::unique_ptr<MatterLaw> law_;
  std::unique_ptr<MatterParticles> particles_;
  std::vector<ToolBody> tools_;
  std::vector<BoundaryBody> bodies_;
  std::vector<BlockSums> sums_;
};

}  // namespace palpate
