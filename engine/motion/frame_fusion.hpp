#pragma once

#include "engine/core/log.hpp"
#include "engine/motion/map_pairs.hpp"
#include "engine/motion/pose_tracker.hpp"

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
  explicit FrameFusion(const FusionOptions& options, const IcpOptions& icp = {}, Log* log = nullptr);

  /// Throws nothing for a frame that is wrong: that is an outcome.
  const FrameOutcome& fuse(const DepthCamera& camera, const DepthFrame& frame);
  /// For a frame that its stream could not give.
  void countLost(std::string_view why);
  /// From the beginning.
  void clear();

  const SurfelMap& map() const { return map_; }
  std::uint64_t fused() const { return fused_; }
  std::uint64_t unplaced() const { return unplaced_; }
  /// Frames that were refused, or could not be read.
  std::uint64_t lost() const { return lost_; }

 private:
  void leaveOut(FrameFate fate, std::uint64_t number, std::string why);

  Log* log_;
  SurfelMap map_;
  FrameImages images_;
  std::vector<shared::PixelSurface> surfaces_;
  PoseTracker tracker_;
  std::uint64_t fused_ = 0, unplaced_ = 0, lost_ = 0;
  bool saidFull_ = false;
  FrameOutcome outcome_;
};

}  // namespace palpate
