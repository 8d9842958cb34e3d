#pragma once

#include <vector>

#include "engine/motion/icp.hpp"
#include "engine/motion/surfel_map.hpp"

namespace palpate {

/// The pairs of a frame's pixels and the points of a map on the host, by projection: a pixel's place falls on the pixel
/// of the map as it is seen from the expected pose. Sums in double precision and in the order of the rows: the same for
/// any number of threads. All that it is made from must outlive it.
class MapPairs {
 public:
  MapPairs(const SurfelMap& map, const FrameImages& images, const std::vector<shared::PixelSurface>& surfaces,
           const CameraPose& expected);

  IcpSums sum(const IcpQuery& query) const;
  /// Which point stands in front in each pixel: the index image. kNoPoint where there is none. Points that face the
  /// camera alone; of two in a pixel the nearer, and of equally near ones the one of the lower id.
  const std::vector<std::uint32_t>& ids() const { return ids_; }
  static constexpr std::uint32_t kNoPoint = 0xffffffffu;

 private:
  void findFront();
  void addPixel(UVec2 pixel, const IcpQuery& query, IcpSums& sums) const;

  const SurfelMap& map_;
  const FrameImages& images_;
  const std::vector<shared::PixelSurface>& surfaces_;
  shared::FusionView view_;  // from the expected pose
  std::vector<std::uint32_t> ids_;
};

/// searchPose() in a map on the host.
IcpResult findPose(const SurfelMap& map, const FrameImages& images, const std::vector<shared::PixelSurface>& surfaces,
                   const CameraPose& expected, const IcpOptions& options = {});

}  // namespace palpate
