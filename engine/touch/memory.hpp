#pragma once

#include <cstdint>

namespace palpate {

class Device;

/// GPU memory that a cloud needs, bytes, known before any upload.
struct GpuMemory {
  std::uint64_t liveCloud = 0;   ///< two orders of positions and normals
  std::uint64_t index = 0;       ///< keys, order, sort scratch, bucket ranges
  std::uint64_t contact = 0;     ///< the points around the probe
  std::uint64_t drawnCloud = 0;  ///< the sight side's copy
  std::uint64_t editing = 0;     ///< spare slots, and the lists by which the index follows edits; only when editing
  std::uint64_t editLog = 0;     ///< only when editing
  std::uint64_t total() const { return liveCloud + index + contact + drawnCloud + editing + editLog; }
};
GpuMemory predictGpuMemory(std::uint64_t points, bool colors);

/// Throws OutOfGpuMemory, with the numbers, if touching that many points cannot fit on `device`.
void requireGpuMemory(const Device& device, std::uint64_t points, bool edits);

}  // namespace palpate
