#include "engine/touch/carried_frames.hpp"

#include "engine/core/check.hpp"

namespace palpate {

namespace {

const FrameCarrier& carrierOf(CloudSource& source) {
  PALPATE_CHECK(source.carrier() != nullptr);
  return *source.carrier();
}

}  // namespace

CarriedFrames::CarriedFrames(CloudSource& source, const DVec3& origin)
    : source_(source), carrier_(carrierOf(source)), origin_(origin) {}

MadeFrame CarriedFrames::make(double time_s, const LiveCloud::Half& /*incoming*/) {
  if (isMade_ && !source_.hasNewer(time_s, time_s_)) return MadeFrame::none;
  isMade_ = true;
  const std::optional<double> trueFor_s = source_.goTo(time_s);
  if (!trueFor_s) return MadeFrame::none;
  time_s_ = *trueFor_s;
  return MadeFrame::recorded;
}

void CarriedFrames::record(CommandList& list, const Front& /*front*/, const LiveCloud::Half& incoming,
                           const Buffer& velocities) const {
  carrier_.recordFrame(list, {.positions = incoming.positions.address(),
                              .normals = incoming.normals.address(),
                              .velocities = velocities.address(),
                              .unitsPerMetre = 1 / kCarriedUnit_m,
                              .origin = origin_});
}

}  // namespace palpate
