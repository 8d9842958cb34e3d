// Matter on the CPU.
#pragma once

#include <memory>

#include "engine/core/worker_team.hpp"
#include "engine/matter/matter_law.hpp"
#include "engine/matter/matter_simulation.hpp"
#include "engine/matter/tool_body.hpp"

namespace palpate {

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
