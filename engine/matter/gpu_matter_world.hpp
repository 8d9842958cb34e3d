// Matter on a GPU.
#pragma once

#include "engine/gpu/command_list.hpp"
#include "engine/gpu/queue.hpp"
#include "engine/matter/boundary.hpp"
#include "engine/matter/matter_passes.hpp"
#include "engine/matter/matter_simulation.hpp"
#include "shaders/shared/matter_passes.h"

namespace palpate {

/// The same as MatterWorld, by the same formulas, in single precision, tools and sums too; on the same GPU the same
/// bytes every time. A step is one submission, after which the host reads its report. A particle has room for fewer
/// neighbours than on the CPU: 128 in water, 64 in sand, more than twice what either comes to.
class GpuMatterWorld final : public MatterSimulation {
 public:
  /// `queue`: of the device, and used by this thread alone. Throws Error as planOf() does, and OutOfGpuMemory.
  GpuMatterWorld(Device& device, Queue& queue, const MatterScene& scene, const MatterOptions& options = {});
  /// The same with particles elsewhere than at rest in the fill, m; those outside of the box stand at its walls.
  GpuMatterWorld(Device& device, Queue& queue, const MatterScene& scene, const MatterOptions& options,
                 std::vector<Vec3> places);

  std::optional<double> gpuTime_us() const override;
  std::vector<PassRecord> passes() const override { return ran_->passes(); }
  std::vector<Vec3> positionsById() const override;
  std::vector<Vec3> velocitiesById() const override;
  void setVelocities(std::span<const Vec3> byId) override;

  /// Substeps since the beginning in which a particle had gone farther than lists allow, and which could make none: two
  /// that have come near in them meet when the next step begins, by weights that begin at 0. The steps that follow one
  /// such can make lists in each substep.
  std::uint32_t lateSubsteps() const { return control().late; }
  /// How often lists were made since the beginning.
  std::uint32_t listsMade() const { return control().lists; }
  /// On the GPU.
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
  CommandList calm_, swift_;  // a step in which lists are made in the beginning alone; in every substep, if need be
  const CommandList* ran_ = &calm_;
  std::uint32_t swiftSteps_ = 0;  // so many more to come
};

}  // namespace palpate
