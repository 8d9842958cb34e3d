// Thin lines in space over a finished picture: cameras, paths, measurements.
#pragma once

#include <array>
#include <span>

#include "engine/gpu/buffer.hpp"
#include "engine/gpu/command_list.hpp"
#include "engine/gpu/compute_pipeline.hpp"
#include "engine/render/camera.hpp"
#include "engine/render/frame_options.hpp"

namespace palpate {

/// Images that lines are drawn into.
struct LineTarget {
  DeviceAddress depthImage;  ///< surface depth, a float per pixel; 0 without a surface
  DeviceAddress image;       ///< RGBA8
};

/// Marks the pixels of each line with their coverage, then blends the marks in. Where lines cross, the more opaque one
/// wins, so that the result does not depend on their order.
class LinePass {
 public:
  /// `pixels`: number of pixels of the pictures.
  LinePass(Device& device, std::uint64_t pixels);

  /// Leaves out lines with a coordinate that is NaN, or 1e30 or more in magnitude, and parts outside the picture.
  void record(CommandList& list, std::span<const SpaceLine> lines, const Camera& camera, const UVec2& size_px,
              const LineTarget& target);

 private:
  // Recordings in flight (Frame::kInFlight): each has its own lines.
  static constexpr std::size_t kInFlight = 3;

  Device& device_;
  std::uint64_t pixels_;
  ComputePipeline mark_, blend_;
  Buffer marks_;
  std::array<Buffer, kInFlight> lines_;
  std::size_t recordings_ = 0;
};

}  // namespace palpate
