#pragma once

#include <vector>

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

}  // namespace palpate
