// Hands that press on the surface of a soft body on a GPU, within its substeps.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "engine/gpu/buffer.hpp"
#include "engine/gpu/command_list.hpp"
#include "engine/gpu/compute_pipeline.hpp"
#include "engine/matter/soft_passes.hpp"
#include "engine/matter/surface_press.hpp"

namespace palpate {

/// Like SoftPress, in single precision. The GPU determines the nodes of each press at the beginning of a step: boxes
/// around the skin positions, by cell and by block, select the candidate nodes. In a substep one workgroup solves all
/// presses: a matrix holds the coupling of their positions through shared nodes, so that the Gauss-Seidel sweep needs
/// only numbers. Its time grows with the number of presses.
class GpuSoftPress {
 public:
  /// `memory` must outlive it. Throws OutOfGpuMemory.
  GpuSoftPress(Device& device, const SoftMemory& memory, const SoftSizes& sizes);

  /// Sets the presses, at most shared::kMaxPresses, for a step of that length. True if previously recorded lists must
  /// be recorded again: there are more presses than ever before.
  bool begin(std::span<const SurfacePress> presses, double duration_s);
  /// Record before the first substep; in each substep between cells and nodes; and at the end.
  void recordBegin(CommandList& list) const;
  void recordSubstep(CommandList& list, std::uint32_t substep, std::uint32_t substeps) const;
  void recordEnd(CommandList& list) const;
  /// Ends the step, after its submission has completed; each press has its report.
  void end();
  /// For a restart of the scene: clears all presses.
  void forget();

  std::span<const PressReport> reports() const { return reports_; }
  /// Impulse on the supports of pinned nodes, over the step, kg m/s.
  const DVec3& onPins() const { return onPins_; }
  std::uint64_t bytes() const;

  /// Row with the nodes of a press.
  struct Row {
    std::uint32_t row = 0;
    bool isSame = false;   ///< kept from the previous step
    bool isAlone = false;  ///< PressReport::isAlone
  };

 private:
  // Buffers per press, for at most `most` presses.
  struct Memory {
    Memory(Device& device, const SoftSizes& sizes, std::uint32_t most);

    std::uint32_t most;
    Buffer asked, count, counts, held, done, doneRead;
  };

  void findRows(std::span<const SurfacePress> presses);

  Device& device_;
  const SoftMemory& body_;
  SoftSizes sizes_;
  ComputePipeline box_, reach_, hold_, share_, couple_, press_;
  Buffer boxes_, blockBoxes_, coupling_;
  std::optional<Memory> memory_;  // allocated at the first press
  std::vector<SurfacePress> presses_;
  std::vector<Row> rows_;  // per press
  std::vector<PressReport> reports_;
  DVec3 onPins_{0};
};

}  // namespace palpate
