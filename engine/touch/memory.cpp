#include "engine/touch/memory.hpp"

#include "engine/contact/contact_step.hpp"
#include "engine/edit/edit_log.hpp"
#include "engine/edit/edit_pass.hpp"
#include "engine/gpu/device.hpp"
#include "engine/spatial/spatial_hash.hpp"

namespace palpate {

GpuMemory predictGpuMemory(std::uint64_t points, bool colors) {
  constexpr std::uint64_t kVec4 = 16, kWord = 4;
  const std::uint64_t spare = HashUpdate::spareSlots(points);
  const std::uint64_t index = SpatialHash::predictedBytes(points);
  return {.liveCloud = 2 * 2 * kVec4 * points,
          .index = index,
          .contact = ContactStep::predictedBytes(points),
          .drawnCloud = (2 * kVec4 + 2 * kWord + (colors ? kWord : 0)) * points,
          .editing = 2 * 2 * kVec4 * spare + SpatialHash::predictedBytes(points, points + spare) - index +
                     EditPass::predictedBytes(points, colors),
          .editLog = EditLog::capacityFor(points) * sizeof(PackedState)};
}

void requireGpuMemory(const Device& device, std::uint64_t points, bool edits) {
  const GpuMemory needs = predictGpuMemory(points, false);
  const std::uint64_t bytes =
      needs.liveCloud + needs.index + needs.contact + (edits ? needs.editing + needs.editLog : 0);
  if (bytes > device.ownMemory())
    throw OutOfGpuMemory("{}: touching {} points needs {} MiB, and the GPU has {} MiB; use a smaller model",
                         device.name(), points, bytes >> 20, device.ownMemory() >> 20);
}

}  // namespace palpate
