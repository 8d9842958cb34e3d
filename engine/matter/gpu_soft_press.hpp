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

/// The same as SoftPress, in single precision. What each press holds is found on the GPU when a step begins: boxes
/// about the places of the skin, cell by cell and block by block, say which nodes to look at. In a substep one
/// workgroup has all presses: places of presses go with each other by the nodes that they share, which a matrix says,
/// so that Gauss and Seidel's sweep is over numbers. Its time grows with the presses.
class GpuSoftPress {
 public:
  /// `memory` must outlive it. Throws OutOfGpuMemory.
  GpuSoftPress(Device& device, const SoftMemory& memory, const SoftSizes& sizes);

  /// From now on these press, at most shared::kMaxPresses, for a step of that length. True where lists that were
  /// recorded before are to be recorded again: there are more presses than ever.
  bool begin(std::span<const SurfacePress> presses, double duration_s);
  /// Before the first substep; then in each one between cells and nodes; and at the end.
  void recordBegin(CommandList& list) const;
  void recordSubstep(CommandList& list, std::uint32_t substep, std::uint32_t substeps) const;
  void recordEnd(CommandList& list) const;
  /// The step is over, and so is what was submitted; each press has its report.
  void end();
  /// The scene begins anew: nobody has pressed.
  void forget();

  std::span<const PressReport> reports() const { return reports_; }
  /// On what holds the nodes that are pinned, over the step, kg m/s.
  const DVec3& onPins() const { return onPins_; }
  std::uint64_t bytes() const;

  /// Where the nodes of a press stand.
  struct Row {
    std::uint32_t row = 0;
    bool isSame = false;   ///< from the step before
    bool isAlone = false;  ///< PressReport::isAlone
  };

 private:
  // By press, for so many of them.
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
  std::optional<Memory> memory_;  // where anybody has pressed
  std::vector<SurfacePress> presses_;
  std::vector<Row> rows_;  // of each
  std::vector<PressReport> reports_;
  DVec3 onPins_{0};
};

}  // namespace palpate
