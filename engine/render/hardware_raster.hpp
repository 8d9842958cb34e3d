#pragma once

#include <memory>

#include "engine/gpu/command_list.hpp"
#include "engine/render/compute_raster.hpp"
#include "engine/render/frame_options.hpp"
#include "shaders/shared/hardware_raster.h"

namespace palpate {

/// Draws discs by the graphics pipeline, for Frame: writes the same depths and sums as the compute passes. A disc is a
/// point sprite: one vertex and one primitive, instead of the six and two of a quad. Discs wider than the GPU's largest
/// point are squares of sprites.
///
/// Pass 1 keeps the nearest depth in a depth attachment, scaled by a power of two, which is exact. Pass 2 tests depths
/// moved towards the eye by the blending band, and sums up in float attachments; blending keeps the order of the
/// points, so that the same input gives the same bytes. A last pass converts depths and sums to the format that the
/// rest of the frame reads.
class HardwareRaster {
 public:
  /// Throws UsageError if the device cannot draw a picture of that many samples.
  HardwareRaster(Device& device, const UVec2& size_px);

  /// Writes the target's depths, sums of normals and, for a cloud with colours, of colours. Draws every point. `frame`
  /// is the future content of `target.frame`, `widest` the largest disc's diameter in model units.
  void record(CommandList& list, const DrawnCloud& cloud, const RasterTarget& target, const shared::RenderFrame& frame,
              double widest);

 private:
  Device& device_;
  GraphicsPipeline depthPass_, normalPass_, colorPass_;
  ComputePipeline sums_;
  Attachment depth_, normals_;
  ImageReads plainReads_;
  std::unique_ptr<Attachment> colors_;  // created with the first cloud that has colours
  std::unique_ptr<ImageReads> colorReads_;
};

}  // namespace palpate
