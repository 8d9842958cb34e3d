#pragma once

#include <functional>

#include "engine/gpu/command_list.hpp"
#include "engine/spatial/spatial_hash.hpp"
#include "shaders/shared/splat_radius.h"

namespace palpate {

/// Measures the radius that each point's disc needs to close the surface around it (shaders/shared/splat_radius.h),
/// with a spatial hash of the sight side, since the drawn cloud is in the order of the file. Works on the throughput
/// queue and waits.
class SplatRadii {
 public:
  /// `places`: maximum number of points; `spacing`: mean, model units, positive. Borders farther than a tenth of the
  /// box are ignored.
  SplatRadii(Device& device, const Bounds& bounds, std::uint32_t places, double spacing);

  /// Writes the radius of every point (model units) into the w of its normal, and how its disc is clipped into `clips`,
  /// a word for each index. `points`: in the order of their ids, with ids in the w of their positions.
  void measure(const LiveCloud::Half& points, const Buffer& clips);
  /// The same only for points with changes near them since the last call; the result equals that of measure().
  void measureChanged(const LiveCloud::Half& points, const Buffer& clips);

  const HashGrid& grid() const { return hash_.grid(); }
  /// One bit per bucket of the grid, set when a point in it is added, removed, moved or rotated.
  DeviceAddress changed() const { return changed_.address(); }
  /// Largest radius ever measured, model units.
  double largest() const;
  std::uint64_t bytes() const;

 private:
  // Builds the hash, and records `then` in the same list.
  void index(const LiveCloud::Half& points, const std::function<void(CommandList&)>& then);
  void measure(const LiveCloud::Half& points, const Buffer& clips, std::uint32_t count, bool onlyListed);

  Device& device_;
  std::uint32_t places_;
  double spacing_, widest_;
  SpatialHash hash_;
  LiveCloud::Half ordered_;  // the points in hash order
  ComputePipeline pass_, changedPass_;
  Buffer reaches_, changed_, largest_, largestRead_;
  Buffer changedSlots_, count_, countRead_;  // points that are measured again
  CommandList list_;
};

}  // namespace palpate
