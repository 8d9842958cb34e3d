#pragma once

#include "engine/gpu/frame_carrier.hpp"
#include "engine/motion/cloud_source.hpp"
#include "engine/touch/frame_writer.hpp"

namespace palpate {

/// Frames of a source that moves its points on the GPU (CloudSource::carrier()): they never reach the host.
class CarriedFrames final : public FrameWriter {
 public:
  /// `source` must outlive it; its carrier must be on the device whose lists record() gets. `origin`: of the live
  /// cloud.
  CarriedFrames(CloudSource& source, const DVec3& origin);

  std::size_t size() const override { return source_.size(); }
  MadeFrame make(double time_s, const LiveCloud::Half& incoming) override;
  void record(CommandList& list, const Front& front, const LiveCloud::Half& incoming,
              const Buffer& velocities) const override;
  double time_s() const override { return time_s_; }
  bool isColored() const override { return false; }

 private:
  CloudSource& source_;
  const FrameCarrier& carrier_;
  DVec3 origin_;
  double time_s_ = 0;
  bool isMade_ = false;  // a frame has been made
};

}  // namespace palpate
