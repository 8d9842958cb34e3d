#pragma once

#include "engine/motion/frame_intake.hpp"
#include "engine/motion/map_pairs.hpp"

namespace palpate {

/// What became of a frame.
enum class FrameFate {
  fused,
  unplaced,  ///< where it was seen from could not be found
  refused    ///< it is none: of another size, or with depths that are no numbers
};

struct FrameOutcome {
  FrameFate fate = FrameFate::refused;
  FusionCounts counts;  ///< of state `fused`
  CameraPose pose;      ///< likewise
  IcpResult search;     ///< of a frame without a pose of its own, but not of the first one
  std::string why;      ///< it was not fused
};

/// Fuses frame after frame into a map on the host: from their own poses, and where they have none, from those that ICP
/// finds against the map so far. The first frame without a pose stands in the middle of the world. A frame that is not
/// fused is counted and said, and leaves the map as it was.
class FrameFusion {
 public:
  /// Throws as FusionOptions::validate(). `log`, if any, must outlive it.
  explicit FrameFusion(const FusionOptions& options, const IcpOptions& icp = {}, Log* log = nullptr)
      : map_(options), intake_(options, icp, log) {}

  /// Throws nothing for a frame that is wrong: that is an outcome.
  const FrameOutcome& fuse(const DepthCamera& camera, const DepthFrame& frame);
  /// For a frame that its stream could not give.
  void countLost(std::string_view why, std::uint64_t frames = 1) { intake_.countLost(why, frames); }
  /// Anew, with the points of a cloud (SurfelMap::begin()), of which the last frame was seen from there.
  void begin(const PointCloud& cloud, const std::optional<CameraPose>& seenFrom);

  const SurfelMap& map() const { return map_; }
  std::uint64_t fused() const { return intake_.fused(); }
  std::uint64_t unplaced() const { return intake_.unplaced(); }
  /// Frames that were refused, or could not be read.
  std::uint64_t lost() const { return intake_.lost(); }

 private:
  const FrameOutcome& leftOut(FrameFate fate);

  SurfelMap map_;
  FrameIntake intake_;
  std::vector<shared::PixelSurface> surfaces_;
  FrameOutcome outcome_;
};

}  // namespace palpate
