#pragma once

#include "engine/gpu/command_list.hpp"
#include "engine/render/drawn_cloud.hpp"
#include "shaders/shared/render.h"

namespace palpate {

/// Where a rasteriser leaves what it found, for each sample: the nearest depth, and the sums of what lies close behind
/// it (shaders/shared/render.h, SplatArgs).
struct RasterTarget {
  DeviceAddress frame;  ///< shared::RenderFrame
  DeviceAddress depth, normalSums, colorSums;
};

/// Draws the discs of a cloud in compute shaders (Zwicker et al. 2001; two passes after Botsch and Kobbelt 2003). Discs
/// that are seen are listed first: where they are finer than samples a share of the points stands for all, and large
/// ones are split into tiles. The same input gives the same bytes on the same device.
class ComputeRaster {
 public:
  /// `wideAtomics`: adds in 64 bits where the device can; the bytes are the same.
  explicit ComputeRaster(Device& device, bool wideAtomics = true);

  void record(CommandList& list, const DrawnCloud& cloud, const RasterTarget& target) const;
  /// What the last completed picture took: counts of discs and shares.
  shared::SplatCounts readCounts() const;

 private:
  Device& device_;
  ComputePipeline pick_, plan_, smallDepth_, largeDepth_, smallAttributes_, largeAttributes_;
  Buffer counts_, shares_;
};

}  // namespace palpate
