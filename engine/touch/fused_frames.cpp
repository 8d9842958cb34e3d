#include "engine/touch/fused_frames.hpp"

#include "engine/core/error.hpp"
#include "engine/gpu/device.hpp"

namespace palpate {

FusedFrames::FusedFrames(Device& device, const FusedStream& frames, std::uint32_t points, std::uint32_t slots,
                         const DVec3& origin)
    : stream_(*frames.stream),
      options_(frames.options),
      pass_(device, stream_.camera(), options_, slots),
      slots_(slots),
      origin_(origin),
      log_(frames.log) {
  pass_.reset(device.latencyQueue(), points);
}

void FusedFrames::lose(std::string_view why) {
  ++lost_;
  if (log_) log_->say("a frame is left out: {}", why);
}

bool FusedFrames::readNext() {
  while (!hasNext_) {
    try {
      if (!stream_.next(next_)) return false;
      hasNext_ = true;
    } catch (const Error& error) {
      lose(error.what());
    }
  }
  return true;
}

bool FusedFrames::puts(const DepthFrame& frame) {
  try {
    if (!frame.pose) throw Error("frame {} does not say where it was seen from", frame.number);
    readFrame(stream_.camera(), frame, options_, images_);
    pass_.put(images_, *frame.pose, origin_);
    return true;
  } catch (const Error& error) {
    lose(error.what());
    return false;
  }
}

bool FusedFrames::make(double time_s) {
  while (readNext()) {
    if (stream_.isRecorded() && next_.time_s > time_s) return false;
    hasNext_ = false;
    if (!puts(next_)) continue;
    time_s_ = next_.time_s;
    ++fused_;
    return true;
  }
  return false;
}

void FusedFrames::record(CommandList& list, const LiveCloud::Half& front, const LiveCloud::Half& incoming,
                         const Buffer& /*velocities*/) const {
  pass_.record(list, front, incoming);
}

}  // namespace palpate
