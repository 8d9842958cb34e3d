#pragma once

#include "engine/gpu/command_list.hpp"
#include "engine/render/compute_raster.hpp"
#include "engine/render/frame_constants.hpp"
#include "engine/render/frame_options.hpp"

namespace palpate {

/// Draws the particles of a cloud as water, over the finished light of what is not water: balls, smoothed on screen
/// into one surface, which reflects the sky; what is behind is shifted by its slope and absorbed over the thickness
/// (shaders/shared/water.h).
class WaterPass {
 public:
  WaterPass(Device& device, const FrameSize& size);

  struct Particles {
    DeviceAddress positions;
    std::uint32_t count;  ///< the first points of the cloud
    double radius, spacing;
    double side;  ///< longest side of the model, model units
  };
  /// What is not water: of the samples (ShadeArgs).
  struct Behind {
    DeviceAddress source, depth, shaded;
  };
  void record(CommandList& list, const Particles& particles, const Behind& behind);

  /// One per sample: light of the picture, as two words, and bits of the depth of the visible surface.
  const Buffer& shaded() const { return shaded_; }
  const Buffer& surface() const { return surface_; }
  /// One per pixel (WaterArgs).
  const Buffer& fronts() const { return fronts_; }
  const Buffer& sums() const { return sums_; }
  const Buffer& smoothed() const { return smoothed_; }
  const Buffer& tidied() const { return across_; }
  /// Fixed-point unit of sums().
  static double unitsInLength(const Particles& particles);

 private:
  std::uint64_t pixels_, samples_;
  ComputePipeline balls_, alongRows_, alongColumns_, tidy_, compose_;
  Buffer fronts_, sums_, across_, smoothed_, shaded_, surface_;
};

}  // namespace palpate
