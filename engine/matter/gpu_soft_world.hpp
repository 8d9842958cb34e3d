// Soft bodies on a GPU.
#pragma once

#include <memory>
#include <optional>

#include "engine/gpu/command_list.hpp"
#include "engine/gpu/queue.hpp"
#include "engine/matter/gpu_soft_compliance.hpp"
#include "engine/matter/gpu_soft_press.hpp"
#include "engine/matter/matter_simulation.hpp"
#include "engine/matter/soft_model.hpp"
#include "engine/matter/soft_passes.hpp"
#include "engine/matter/soft_sculpture.hpp"

namespace palpate {

/// Like SoftWorld, with the same formulas, in single precision, including tools and sums; on the same GPU the results
/// are always bitwise identical. A step is one submission, after which the host reads its report and detects
/// divergence.
class GpuSoftWorld final : public MatterSimulation, public FrameCarrier {
 public:
  /// The body of a scene without a model, or of MatterOptions::soft. `queue`: of the device, and used only by this
  /// thread. Throws Error as planOf() does, and OutOfGpuMemory.
  GpuSoftWorld(Device& device, Queue& queue, const MatterScene& scene, const MatterOptions& options = {});
  /// A filled body (soft_scan.hpp), and the `points` that it carries: surface points in any number and order; if empty,
  /// the points of its skin.
  GpuSoftWorld(Device& device, Queue& queue, const MatterScene& scene, const MatterOptions& options,
               const SoftSolid& solid, std::span<const SurfacePlace> points);

  /// With a queue of its own, for a thread of its own.
  GpuSoftWorld(Device& device, std::unique_ptr<Queue> queue, const MatterScene& scene, const MatterOptions& options);
  /// An existing body, which may be shared.
  GpuSoftWorld(Device& device, Queue& queue, const MatterScene& scene, const MatterOptions& options,
               const std::shared_ptr<const SoftModel>& model);

  std::size_t nodes() const { return sizes_.nodes; }
  std::size_t points() const { return sizes_.points; }
  /// The compression is that of the most compressed cell.
  MatterObservation observe() const override;
  /// The frame of the points that it carries, via the host.
  void makeFrame(CloudFrame& frame) override;
  /// The same into GPU memory, for use on the GPU; m, m/s. Waits; valid until the next call.
  CarriedPoints carry();
  bool makeFrameThere() override {
    carry();
    return true;
  }
  std::optional<double> frameTime_us() const override;
  FrameCarrier* carrier() override { return this; }
  void carryVelocities(bool carries) override;
  void recordFrame(CommandList& list, const CarriedPoints& to) const override {
    passes_.recordFrame(list, memory_, sizes_, to);
  }

  void press(std::span<const SurfacePress> presses) override { presses_.assign(presses.begin(), presses.end()); }
  std::span<const PressReport> pressed() const override { return press_.reports(); }
  bool hasSurface() const override { return true; }
  /// As in SoftWorld: conjugate gradients on the GPU. The host computes the distribution of the force.
  double localCompliance_m_N(const DVec3& place_m, double radius_m, const DVec3& direction) override;

  /// The shape is changed on the host: beginSculpting() downloads all nodes, and endSculpting() uploads the changes, 32
  /// bytes per node each way.
  SoftSculpture* sculpture() override { return tools() == 0 ? &sculpture_ : nullptr; }
  void beginSculpting() override;
  void endSculpting() override;

  std::optional<double> gpuTime_us() const override;
  std::vector<PassRecord> passes() const override;  ///< including those of the last frame
  std::vector<Vec3> positionsById() const override;
  std::vector<Vec3> velocitiesById() const override;
  void setVelocities(std::span<const Vec3> byId) override;
  /// Displacement of each node from its lattice position, m; pinned nodes stay there.
  std::vector<Vec3> displacements() const { return ofNodes(0); }
  void setDisplacements(std::span<const Vec3> byId);

  double mass_kg() const { return body_.mass_kg(); }
  /// Bytes on the GPU.
  std::uint64_t bytes() const;

 private:
  // Buffers of the points, m, and the list that writes them.
  struct Frames {
    Frames(GpuSoftWorld& world);
    CarriedPoints points() const;

    Buffer positions, normals, velocities;
    CommandList list;
  };
  GpuSoftWorld(Device& device, std::unique_ptr<Queue> queue, const MatterScene& scene, const MatterOptions& options,
               const std::shared_ptr<const SoftModel>& model);
  GpuSoftWorld(Device& device, Queue* queue, const MatterScene& scene, const MatterOptions& options,
               std::shared_ptr<const SoftModel> model, const SoftLayout& layout, std::unique_ptr<Queue> own);
  void begin() override;
  void takeParameters() override;
  void placeToolAt(std::size_t tool, const HandPose& hand) override;
  StepReport run(std::span<const HandPose> from, std::span<const HandPose> to) override;
  std::vector<Vec4> pressedPlaces() const override { return {}; }  // no pressure

  CommandList::Timing timing() const {
    return timesPasses_ ? CommandList::Timing::passes : CommandList::Timing::sections;
  }
  void uploadBody(const SoftLayout& layout);
  void uploadPoints(const SoftLayout& layout);
  void uploadNodes(std::span<const Vec3> displacements, std::span<const Vec3> velocities);
  void uploadShapes(std::span<const std::uint32_t> nodes);
  void stiffenSkin(double times);
  void recordSteps();
  void record(CommandList& list, const GpuSoftPress* press);
  const CommandList& listOfStep();
  std::vector<Vec3> ofNodes(std::size_t vec4) const;
  void setNodes(std::size_t vec4, std::span<const Vec3> byId);
  Frames& frames();

  Device& device_;
  std::unique_ptr<Queue> own_;  // if it has its own
  Queue& queue_;
  std::shared_ptr<const SoftModel> model_;
  SoftBody body_;  // at rest; with present node positions during sculpting
  SoftSurface surface_;
  SoftSculpture sculpture_;
  std::vector<Vec3> shape_;            // rest displacements on the GPU, m
  std::vector<std::uint32_t> slotOf_;  // SoftLayout::slotOf
  DVec3 gravityOfSubstep_{0};          // on the free nodes, kg m/s
  double touchFrequency_rad_s_;
  SoftSizes sizes_;
  SoftMemory memory_;
  SoftPasses passes_;
  GpuSoftPress press_;
  std::vector<SurfacePress> presses_;  // presses of the next step
  std::optional<GpuSoftCompliance> compliance_;
  bool timesPasses_;
  bool carriesVelocities_ = true;
  CommandList step_;
  std::unique_ptr<CommandList> pressedStep_;  // created at the first press
  const CommandList* ran_ = &step_;           // the last step's list
  std::unique_ptr<Frames> frames_;            // created at the first frame
};

}  // namespace palpate
