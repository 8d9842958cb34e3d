// Touch while depth frames are received: for `bench stream --felt`.
#pragma once

#include <vector>

#include "apps/cli/context.hpp"
#include "engine/cloud/point_cloud.hpp"
#include "engine/core/depth_stream.hpp"
#include "engine/core/statistics.hpp"

namespace palpate {

/// A hand that slides over a map in real time, at 1000 ticks a second, while the map is drawn one picture after
/// another.
struct FeltStream {
  std::string situation;  ///< "still", "latest" frame or "fused"
  std::uint64_t ticks = 0, contactTicks = 0, missedTicks = 0;
  double freshShare = 0;            ///< fraction of the ticks that were answered in time
  Summary step_us;                  ///< from pose to force
  std::uint64_t frames = 0;         ///< frames that were felt
  std::uint64_t framesDropped = 0;  ///< superseded by newer ones
  double pictures_per_s = 0;
  std::uint64_t framesDrawn = 0;
  std::string framesOf;     ///< FeltScene::framesOf
  std::size_t surfels = 0;  ///< points of the map
};

struct FeltScene {
  const PointCloud& map;  ///< metres
  DepthCamera camera;
  const std::vector<DepthFrame>& frames;  ///< with poses; repeated in a cycle, 30 a second
  std::string framesOf;                   ///< their size in words
  double radius_m = 0;                    ///< radius of the sphere about the origin that the frames show, seen along z
  double spacing_m = 0;                   ///< spacing of the map
  double duration_s = 0;
};
/// Without frames, with the newest frame as the cloud, and with frames fused into the map.
std::vector<FeltStream> feelStreams(Context& context, const FeltScene& scene);

}  // namespace palpate
