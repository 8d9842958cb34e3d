#pragma once

#include <cstdint>

namespace palpate {

/// What a cloud needs on the GPU, bytes, known before anything is uploaded.
struct GpuMemory {
  std::uint64_t liveCloud = 0;   ///< two orders of positions and normals
  std::uint64_t index = 0;       ///< keys, order, sort scratch, bucket ranges
  std::uint64_t drawnCloud = 0;  ///< the sight side's copy
  std::uint64_t editLog = 0;     ///< with the list of moved points; only when editing
  std::uint64_t total() const { return liveCloud + index + drawnCloud + editLog; }
};
GpuMemory predictGpuMemory(std::uint64_t points, bool colors);

}  // namespace palpate
