#pragma once

#include <mutex>

#include "engine/motion/cloud_source.hpp"
#include "engine/motion/frame_fusion.hpp"

namespace palpate {

/// The map that the frames of a recorded depth stream fuse into, as it was at a time: points in metres, relative to the map's
/// origin.
class FusedSource final : public CloudSource {
 public:
  /// `log`, if any, must outlive it. Throws as FusionOptions::validate().
  FusedSource(std::shared_ptr<DepthStream> stream, const FusionOptions& options, const IcpOptions& icp = {}, Log* log = nullptr);

  std::size_t size() const override { return fusion_.map().options().capacity; }
  bool keepsPoints() const override { return true; }
  /// All frames up to that time are fused, from the first one on where time has gone back. A frame that cannot be read, placed or fused is counted, and the map stays as it was.
  void makeFrame(double time_s, CloudFrame& frame) override;
  bool hasNewer(double time_s, double than_s) override;

  /// Frames that were fused count as played, and those that could not be placed as lost.
  std::optional<PlayCounts> playCounts() const override {
    return PlayCounts{.played = fusion_.fused(), .lost = fusion_.lost() + fusion_.unplaced()};
  }
  std::optional<PlayedView> playedView() const override;
  const FrameFusion& fusion() const { return fusion_; }

 private:
  bool readNext();
  void fuseNext();
  void rewind();

  std::shared_ptr<DepthStream> stream_;
  FrameFusion fusion_;
  DepthFrame next_;  // that was read and not fused, where `hasNext_`
  bool hasNext_ = false, ended_ = false;
  double time_s_ = 0;  // of the frame that was fused last

  mutable std::mutex mutex_;
  std::optional<PlayedView> view_;  // of that frame, where it says it; under the mutex
};

}  // namespace palpate
