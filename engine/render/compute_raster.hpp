#pragma once

#include "engine/gpu/command_list.hpp"
#include "engine/render/drawn_cloud.hpp"
#include "shaders/shared/render.h"

namespace palpate {

/// Output of a rasteriser for each sample: the nearest depth, and sums over the surface close behind it
/// (shaders/shared/render.h, SplatArgs).
struct RasterTarget {
  DeviceAddress depth, normalSums, colorSums;
};

/// Draws the discs of a cloud in compute shaders (Zwicker et al. 2001; two passes after Botsch and Kobbelt 2003).
/// Visible discs are listed first: where they are finer than samples a subset of the points is drawn, and large ones
/// are split into tiles. The same input gives the same bytes on the same device.
class ComputeRaster {
 public:
  /// `wideAtomics`: uses 64-bit atomics if the device has them; the result is the same.
  explicit ComputeRaster(Device& device, bool wideAtomics = true);

  void record(CommandList& list, const DrawnCloud& cloud, const RasterTarget& target) const;
  /// Counts of discs and shares in the last completed picture.
  shared::SplatCounts readCounts() const;

 private:
  Device& device_;
  ComputePipeline pick_, plan_, smallDepth_, largeDepth_, smallAttributes_, largeAttributes_;
  Buffer counts_, shares_;
};

}  // namespace palpate
