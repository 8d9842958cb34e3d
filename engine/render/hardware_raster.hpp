#pragma once

#include <memory>

#include "engine/gpu/command_list.hpp"
#include "engine/render/compute_raster.hpp"
#include "engine/render/frame_options.hpp"
#include "shaders/shared/hardware_raster.h"

namespace palpate {

/// Discs by the graphics pipeline, for Frame: leaves the same depths and sums as the compute passes. A disc is a point
/// sprite: one vertex and one primitive, where a quad is six and two. Where discs may be wider than the GPU's points,
/// each is a square of them.
///
/// Pass 1 keeps the nearest depth in a depth attachment, as the depth times a power of two, so that no bit of it is
/// lost. Pass 2 tests depths brought forward by the blending band and adds up in float attachments; blending keeps the
/// order of the points, so that the same input gives the same bytes here, too. A last pass brings depths and sums into
/// the form that the rest of the frame reads.
class HardwareRaster {
 public:
  /// Throws UsageError where the device cannot do this for a picture of so many samples.
  HardwareRaster(Device& device, const UVec2& size_px);

  /// Fills the target's depths, sums of normals and, for a cloud with colours, of colours. Draws every point. `frame`
  /// is what `target.frame` will hold, `widest` the largest disc's diameter in model units.
  void record(CommandList& list, const DrawnCloud& cloud, const RasterTarget& target, const shared::RenderFrame& frame,
              double widest);

 private:
  Device& device_;
  GraphicsPipeline depthPass_, normalPass_, colorPass_;
  ComputePipeline sums_;
  Attachment depth_, normals_;
  ImageReads plainReads_;
  std::unique_ptr<Attachment> colors_;  // made with the first cloud that has some
  std::unique_ptr<ImageReads> colorReads_;
};

}  // namespace palpate
