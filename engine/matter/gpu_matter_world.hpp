// Matter on a GPU.
#pragma once

#include "engine/gpu/command_list.hpp"
#include "engine/gpu/queue.hpp"
#include "engine/matter/boundary.hpp"
#include "engine/matter/matter_passes.hpp"
#include "engine/matter/matter_simulation.hpp"
#include "shaders/shared/matter_passes.h"

namespace palpate {

/// Like MatterWorld, with the same formulas, in single precision, including tools and sums; on the same GPU the results
/// are always bitwise identical. A step is one submission, after which the host reads its report. A particle has room
/// for fewer neighbours than on the CPU: 128 in water, 64 in sand, more than twice what occurs in either.
class GpuMatterWorld final : public MatterSimulation {
 public:
  /// `queue`: of the device, and used only by this thread. Throws Error as planOf() does, and OutOfGpuMemory.
  GpuMatterWorld(Device& device, Queue& queue, const MatterScene& scene, const MatterOptions& options = {});
  /// The same with other initial positions than at rest in the fill, m; those outside the box are clamped to its walls.
  GpuMatterWorld(Device& device, Queue& queue, const MatterScene& scene, const MatterOptions& options,
                 std::vector<Vec3> places);

  std::optional<double> gpuTime_us() const override;
  std::vector<PassRecord> passes() const override { return ran_->passes(); }
  std::vector<Vec3> positionsById() const override;
  std::vector<Vec3> velocitiesById() const override;
  void setVelocities(std::span<const Vec3> byId) override;

  /// Number of substeps since the start in which a particle had moved farther than the lists allow, but the substep
  /// could not rebuild them: two particles that approached each other in it interact from the next step on, with
  /// weights that begin at 0. The steps after such a substep can rebuild the lists in each substep.
  std::uint32_t lateSubsteps() const { return control().late; }
  /// Number of list builds since the start.
  std::uint32_t listsMade() const { return control().lists; }
  /// Bytes on the GPU.
  std::uint64_t bytes() const { return memory_.bytes(); }

 private:
  void begin() override;
  void takeParameters() override;
  void placeToolAt(std::size_t tool, const HandPose& hand) override;
  StepReport run(std::span<const HandPose> from, std::span<const HandPose> to) override;
  std::vector<Vec4> pressedPlaces() const override;

  void record(CommandList& step, bool swift);
  bool areSwift(std::span<const HandPose> from, std::span<const HandPose> to) const;
  void choose(const shared::MatterControl& before);
  std::vector<Vec3> byId(const Buffer& slots, std::uint64_t firstSlot) const;
  const shared::MatterControl& control() const { return memory_.stateRead.mapped<const shared::MatterControl>()[0]; }

  Device& device_;
  Queue& queue_;
  BoundaryBody ball_;
  MatterSizes sizes_;
  MatterMemory memory_;
  MatterPasses passes_;
  CommandList calm_, swift_;  // a step that rebuilds lists only at its start; one that can do so in each substep
  const CommandList* ran_ = &calm_;
  std::uint32_t swiftSteps_ = 0;  // number of further swift steps
};

}  // namespace palpate
