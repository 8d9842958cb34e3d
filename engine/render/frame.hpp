#pragma once

#include "engine/gpu/command_list.hpp"
#include "engine/render/camera.hpp"
#include "engine/render/compute_raster.hpp"
#include "engine/render/drawn_cloud.hpp"
#include "engine/render/drawn_mesh.hpp"
#include "engine/render/frame_constants.hpp"
#include "engine/render/frame_options.hpp"
#include "engine/render/hardware_raster.hpp"
#include "engine/render/image.hpp"
#include "engine/render/shading.hpp"
#include "engine/render/triangle_raster.hpp"

namespace palpate {

class GaussianPass;
class Ground;
class WaterPass;

/// Whether a picture of this cloud with these options is composited of the file's Gaussians: for its own colours, as
/// fields, heights, normals and most passes are of the surface.
bool showsGaussians(const DrawnCloud& cloud, const FrameOptions& options);

/// A picture of a cloud by surface splatting (Zwicker et al. 2001), in compute shaders or by the graphics pipeline, or
/// of its Gaussians, or of a mesh by its triangles: the passes and the images between them. The same input gives the
/// same bytes on the same device. Part of the sight side.
class Frame {
 public:
  /// Number of recordings in flight: each has its own constants.
  static constexpr std::uint32_t kInFlight = 3;

  /// Throws UsageError for a size that cannot be drawn.
  static void checkSize(std::uint32_t width, std::uint32_t height);
  /// `supersample` (1 or 2): samples along each side of a pixel. `wideAtomics`: see ComputeRaster. Throws like
  /// checkSize().
  Frame(Device& device, std::uint32_t width, std::uint32_t height, std::uint32_t supersample = 2,
        bool wideAtomics = true);
  ~Frame();

  void record(CommandList& list, const DrawnCloud& cloud, const Camera& camera, const FrameOptions& options);
  /// The same for a mesh, which is lit by its vertices' normals; ignores the options for splats.
  void record(CommandList& list, DrawnMesh mesh, const Camera& camera, const FrameOptions& options);

  /// The last completed frame; waits for the throughput queue.
  Image readColor() const;
  DepthImage readDepth() const;
  /// For a cloud drawn in compute: number of discs drawn.
  std::uint32_t readDiscs() const;

  std::uint32_t width() const { return size_.width; }
  std::uint32_t height() const { return size_.height; }
  /// width x height RGBA8.
  const Buffer& image() const { return shading_.image(); }
  /// width x height floats: depth of the visible surface, model units; 0 without a surface.
  const Buffer& depthImage() const { return shading_.depthImage(); }

 private:
  UVec2 size_px() const { return {size_.width * size_.supersample, size_.height * size_.supersample}; }
  std::uint64_t samples() const { return std::uint64_t{size_px().x} * size_px().y; }
  // Begins a recording: also writes its constants.
  RasterTarget begin(CommandList& list, const Drawn& about, const Camera& camera, const FrameOptions& options,
                     std::uint32_t tiles);
  void recordClear(CommandList& list, bool colors) const;
  // Replaces all but the shading.
  void recordGaussians(CommandList& list, const DrawnCloud& cloud, const Camera& camera, FrameOptions options);
  // Replaces clearing and the compute passes.
  void recordHardware(CommandList& list, const DrawnCloud& cloud, const RasterTarget& target, const Drawn& about,
                      const Camera& camera, const FrameOptions& options);
  /// The map of the ground for a picture with its shadow, after the model's changes; null: a picture without.
  template <class Cloud>
  const Ground* ground(CommandList& list, const Cloud& cloud, const Drawn& about, const FrameOptions& options);
  void readBack(const Buffer& from, std::span<std::byte> to) const;

  Device& device_;
  FrameSize size_;
  ComputeRaster raster_;
  TriangleRaster triangles_;
  Shading shading_;
  std::unique_ptr<HardwareRaster> hardware_;  // made at its first use
  std::unique_ptr<Ground> ground_;            // these likewise
  std::unique_ptr<GaussianPass> gaussians_;
  std::unique_ptr<WaterPass> water_;
  ConstantBlock constants_;
  std::uint32_t recordings_ = 0;
  Buffer depth_, normalSums_, colorSums_;
};

}  // namespace palpate
