#pragma once

#include <functional>

#include "engine/gpu/command_list.hpp"
#include "engine/spatial/spatial_hash.hpp"
#include "shaders/shared/splat_radius.h"

namespace palpate {

/// Measures how wide each point's disc must be to close the surface around it (shaders/shared/splat_radius.h), by a
/// hash of the sight side's own: the drawn cloud is in the order of the file. Works on the throughput queue and waits.
class SplatRadii {
 public:
  /// `places`: points at most; `spacing`: mean, model units, positive. No border farther than a tenth of the box
  /// counts.
  SplatRadii(Device& device, const Bounds& bounds, std::uint32_t places, double spacing);

  /// Writes the radius of every point (model units) into the w of its normal, and where its disc is cut off into
  /// `clips`, a word for each place. `points`: in the order of their ids, with ids in the w of their positions.
  void measure(const LiveCloud::Half& points, const Buffer& clips);
  /// The same for those alone about which something has changed since: all radii are then what measure() would give.
  void measureChanged(const LiveCloud::Half& points, const Buffer& clips);

  const HashGrid& grid() const { return hash_.grid(); }
  /// A bit for each bucket of the grid, to be set when a point in it has come, gone, moved or turned.
  DeviceAddress changed() const { return changed_.address(); }
  /// Of all radii that were ever measured, model units.
  double largest() const;
  std::uint64_t bytes() const;

 private:
  // Builds the hash, and does `then` in the same list.
  void index(const LiveCloud::Half& points, const std::function<void(CommandList&)>& then);
  void measure(const LiveCloud::Half& points, const Buffer& clips, std::uint32_t count, bool onlyListed);

  Device& device_;
  std::uint32_t places_;
  double spacing_, widest_;
  SpatialHash hash_;
  LiveCloud::Half ordered_;  // the points in hash order
  ComputePipeline pass_, changedPass_;
  Buffer reaches_, changed_, largest_, largestRead_;
  Buffer changedSlots_, count_, countRead_;  // of the points that are measured again
  CommandList list_;
};

}  // namespace palpate
