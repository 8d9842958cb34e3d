#pragma once

#include <vector>

#include "engine/motion/frame_intake.hpp"
#include "engine/motion/icp.hpp"
#include "engine/motion/surfel_map.hpp"

namespace palpate {

/// Pairs a frame's pixels with points of a map on the host, by projection into the map's index image from the expected
/// pose. Sums in double precision in the order of rows: independent of the number of threads. Its arguments must
/// outlive it.
class MapPairs {
 public:
  MapPairs(const SurfelMap& map, const FrameImages& images, const std::vector<shared::PixelSurface>& surfaces,
           const CameraPose& expected);

  IcpSums sum(const IcpQuery& query) const;
  /// Index image: id of the frontmost point in each pixel; kNoPoint: none. Only points that face the camera; the nearer
  /// of two in a pixel, at equal depth the one with the lower id.
  const std::vector<std::uint32_t>& ids() const { return ids_; }
  static constexpr std::uint32_t kNoPoint = 0xffffffffu;

 private:
  void findFront();
  void addPixel(UVec2 pixel, const IcpQuery& query, IcpSums& sums) const;

  const SurfelMap& map_;
  const FrameImages& images_;
  const std::vector<shared::PixelSurface>& surfaces_;
  shared::FusionView view_;  // expected pose
  std::vector<std::uint32_t> ids_;
};

/// searchPose() in a map on the host.
IcpResult findPose(const SurfelMap& map, const FrameImages& images, const std::vector<shared::PixelSurface>& surfaces,
                   const CameraPose& expected, const IcpOptions& options = {});

/// Outcome of a frame.
enum class FrameFate {
  fused,
  unplaced,  ///< its pose could not be found
  refused    ///< invalid: wrong size, or depths that are not finite
};

struct FrameOutcome {
  FrameFate fate = FrameFate::refused;
  FusionCounts counts;  ///< for `fused` only
  CameraPose pose;      ///< likewise
  IcpResult search;     ///< for a frame without a pose, except the first one
  std::string why;      ///< reason if it was not fused
};

/// Fuses frames into a map on the host, from their own poses or from poses that ICP finds against the map so far. The
/// first frame without a pose is at the world's origin. A frame that is not fused is counted and reported, and leaves
/// the map unchanged.
class FrameFusion {
 public:
  /// Throws like FusionOptions::validate(). `log`, if any, must outlive the object.
  explicit FrameFusion(const FusionOptions& options, const IcpOptions& icp = {}, Log* log = nullptr)
      : map_(options), intake_(options, icp, log) {}

  /// Does not throw for an invalid frame: that is an outcome.
  const FrameOutcome& fuse(const DepthCamera& camera, const DepthFrame& frame);
  /// For a frame that the stream could not read.
  void countLost(std::string_view why, std::uint64_t frames = 1) { intake_.countLost(why, frames); }
  /// Restarts with the points of a cloud (SurfelMap::begin()); `seenFrom`: pose of the last frame in it.
  void begin(const PointCloud& cloud, const std::optional<CameraPose>& seenFrom);

  const SurfelMap& map() const { return map_; }
  std::uint64_t fused() const { return intake_.fused(); }
  std::uint64_t unplaced() const { return intake_.unplaced(); }
  /// Frames that were invalid or could not be read.
  std::uint64_t lost() const { return intake_.lost(); }

 private:
  const FrameOutcome& leftOut(FrameFate fate);

  SurfelMap map_;
  FrameIntake intake_;
  std::vector<shared::PixelSurface> surfaces_;
  FrameOutcome outcome_;
};

}  // namespace palpate
