#pragma once

#include <optional>

#include "engine/core/log.hpp"
#include "engine/motion/fusion_pass.hpp"
#include "engine/touch/frame_writer.hpp"

namespace palpate {

/// Depth frames that are to be fused on the GPU. `stream` and `log`, if any, outlive what fuses them.
struct FusedStream {
  DepthStream* stream = nullptr;
  FusionOptions options;
  Log* log = nullptr;
};

/// The map that depth frames fuse into on the GPU, as points of the live cloud: what has been done to those since the
/// last frame stays. Each frame says where it was seen from.
class FusedFrames final : public FrameWriter {
 public:
  /// `points`: of the live cloud at first, which have the first ids and count as measured; `origin`: of its places in the
  /// world. Throws as FusionPass.
  FusedFrames(Device& device, const FusedStream& frames, std::uint32_t points, std::uint32_t slots, const DVec3& origin);

  std::size_t size() const override { return slots_; }
  /// The next frame that is due; one that cannot be read or fused, or that does not say where it was seen from, is counted
  /// and left out.
  bool make(double time_s) override;
  void record(CommandList& list, const LiveCloud::Half& front, const LiveCloud::Half& incoming,
              const Buffer& velocities) const override;
  double time_s() const override { return time_s_; }
  bool isColored() const override { return true; }

  /// Frames that were fused, and that were left out.
  std::uint64_t fused() const { return fused_; }
  std::uint64_t lost() const { return lost_; }
  /// Of the frame that was fused last, once its list has run.
  FusionCounts counts() const { return pass_.counts(); }

 private:
  bool readNext();
  bool puts(const DepthFrame& frame);
  void lose(std::string_view why);

  DepthStream& stream_;
  FusionOptions options_;
  FusionPass pass_;
  std::uint32_t slots_;
  DVec3 origin_;
  Log* log_;
  FrameImages images_;
  DepthFrame next_;  // that was read and is not due yet, where `hasNext_`
  bool hasNext_ = false;
  double time_s_ = 0;
  std::uint64_t fused_ = 0, lost_ = 0;
};

}  // namespace palpate
