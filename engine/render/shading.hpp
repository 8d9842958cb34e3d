#pragma once

#include <memory>
#include <optional>

#include "engine/gpu/command_list.hpp"
#include "engine/render/camera.hpp"
#include "engine/render/compute_raster.hpp"
#include "engine/render/frame_constants.hpp"
#include "engine/render/frame_options.hpp"
#include "engine/render/line_pass.hpp"
#include "engine/render/water_pass.hpp"

namespace palpate {

class GaussianPass;
class Ground;
class Relief;

/// Converts a rasteriser's output to the picture: assigns surfaces to samples, smooths depth if requested, lights,
/// resolves the samples of each pixel, and draws overlays.
class Shading {
 public:
  Shading(Device& device, const FrameSize& size);
  ~Shading();

  /// What is drawn over the surface. Null: none.
  struct Over {
    const Ground* ground = nullptr;  ///< its shadow
    const GaussianPass* gaussians = nullptr;
    WaterPass* water = nullptr;
    WaterPass::Particles particles = {};
  };
  void record(CommandList& list, const RasterTarget& target, const Camera& camera, const FrameOptions& options,
              const Over& over);

  /// A word for each pixel, RGBA8.
  const Buffer& image() const { return image_; }
  /// A float for each pixel: depth of the visible surface, model units; 0 without a surface.
  const Buffer& depthImage() const { return depthImage_; }

 private:
  std::uint64_t pixels() const { return std::uint64_t{size_.width} * size_.height; }
  std::uint64_t samples() const { return pixels() * size_.supersample * size_.supersample; }
  void recordLines(CommandList& list, const Camera& camera, const FrameOptions& options);
  void recordShade(CommandList& list, const RasterTarget& target, DeviceAddress depth, const Light& light);
  // Returns the address of the depth to be shaded.
  DeviceAddress recordSmoothing(CommandList& list, DeviceAddress depth);

  Device& device_;
  FrameSize size_;
  ComputePipeline closeHoles_, smoothDepth_, shade_, resolve_, overlay_;
  Buffer smoothed_;  // allocated at the first use
  Buffer source_, shaded_, image_, depthImage_;
  // Created at their first use:
  std::optional<ComputePipeline> reliefShade_, eyeDome_;
  std::unique_ptr<Relief> relief_;
  std::unique_ptr<LinePass> lines_;
};

}  // namespace palpate
