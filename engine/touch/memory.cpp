#include "engine/touch/memory.hpp"

#include "engine/edit/edit_log.hpp"
#include "engine/spatial/spatial_hash.hpp"

namespace palpate {

GpuMemory predictGpuMemory(std::uint64_t points, bool colors) {
  constexpr std::uint64_t kVec4 = 16, kWord = 4;
  return {.liveCloud = 2 * 2 * kVec4 * points,
          .index = SpatialHash::predictedBytes(points),
          .drawnCloud = (2 * kVec4 + kWord + (colors ? kWord : 0)) * points,
          .editLog = EditLog::capacityFor(points) * sizeof(shared::EditEntry) + kWord * points};
}

}  // namespace palpate
