#pragma once

#include "engine/gpu/command_list.hpp"
#include "engine/render/compute_raster.hpp"
#include "engine/render/frame_constants.hpp"

namespace palpate {

/// Passes over the finished surface of a picture, one value per pixel: the share of the sky that is visible from it
/// (Jimenez et al. 2016), and its cavities. Nothing is kept from picture to picture, and their patterns depend on the
/// pixel alone.
class Relief {
 public:
  Relief(Device& device, const FrameSize& size);

  /// What was requested of the passes, for the shading; 0: not requested.
  struct Result {
    DeviceAddress surfels = 0;  ///< an UVec2 per pixel (shaders/render/surfel.glsl)
    DeviceAddress access = 0;   ///< a float per pixel, 0 to 1
    DeviceAddress cavity = 0;   ///< a float per pixel: factor on the light
  };
  /// `normalSums`, `source`: of the samples (ShadeArgs). `depth`: as shaded.
  Result record(CommandList& list, DeviceAddress normalSums, DeviceAddress source, DeviceAddress depth, bool occlusion,
                bool cavity);

  const Buffer& access() const { return access_; }
  const Buffer& cavity() const { return cavity_; }

 private:
  std::uint64_t pixels_;
  ComputePipeline gather_, occlude_, blur_, bend_;
  Buffer surfels_, rough_, access_, cavity_;
};

}  // namespace palpate
