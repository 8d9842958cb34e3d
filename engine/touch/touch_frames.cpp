#include "engine/touch/touch_frames.hpp"

#include "engine/cloud/point_cloud.hpp"
#include "engine/touch/carried_frames.hpp"
#include "engine/touch/fused_frames.hpp"
#include "engine/touch/host_frames.hpp"

namespace palpate {

namespace {

// A cloud whose index is always rebuilt needs spare slots only for new points.
constexpr std::uint32_t kFewerSpare = 4;

std::unique_ptr<FrameWriter> writerOf(Device& device, const TouchOptions& options, const LiveCloud& cloud,
                                      const DVec3& origin) {
  PALPATE_CHECK(!(options.source && options.fusion));
  if (options.fusion) return std::make_unique<FusedFrames>(device, *options.fusion, cloud);
  if (options.source && options.source->carrier()) return std::make_unique<CarriedFrames>(*options.source, origin);
  if (options.source) return std::make_unique<HostFrames>(device, *options.source);
  return nullptr;
}

}  // namespace

std::uint32_t spareSlots(const PointCloud& cloud, const TouchOptions& options) {
  if (moves(options)) {
    const std::size_t slots = options.fusion ? options.fusion->options.capacity : options.source->size();
    PALPATE_CHECK_LE(cloud.size(), slots);
    return static_cast<std::uint32_t>(slots - cloud.size());
  }
  if (!options.brush) return 0;
  const std::uint32_t spare = HashUpdate::spareSlots(cloud.size());
  return options.index == IndexFollow::rebuild ? spare / kFewerSpare : options.spareSlots.value_or(spare);
}

TouchFrames::TouchFrames(Device& device, const TouchOptions& options, LiveIndex& index, const DVec3& origin)
    : index_(index), writer_(writerOf(device, options, index.cloud(), origin)) {
  if (writer_) frames_.emplace(device, *writer_, index_);
}

PointsMotion TouchFrames::motionSince(double last_s, double now_s) const {
  return frames_ ? pointsMotion(now_s, pointsTime(), last_s) : PointsMotion{};
}

std::size_t TouchFrames::readBack(PointCloud& cloud) const { return placeAt(frames_->front(), cloud); }

}  // namespace palpate
