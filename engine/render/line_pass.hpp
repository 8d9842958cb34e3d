// Thin lines in space over a finished picture: cameras, ways, measures.
#pragma once

#include <array>
#include <span>

#include "engine/gpu/buffer.hpp"
#include "engine/gpu/command_list.hpp"
#include "engine/gpu/compute_pipeline.hpp"
#include "engine/render/camera.hpp"
#include "engine/render/frame_options.hpp"

namespace palpate {

/// What lines are drawn into, and from where it is seen.
struct LineTarget {
  DeviceAddress frame;       ///< shared::RenderFrame
  DeviceAddress depthImage;  ///< of the surface, a float for each pixel; 0 where nothing is
  DeviceAddress image;       ///< RGBA8
};

/// Marks the pixels that each line covers, by how much of a pixel's width it does, and then blends the marks in. Of
/// lines that cross, the more opaque is seen, so that their order means nothing and the same lines give the same bytes.
class LinePass {
 public:
  /// `pixels`: of the pictures.
  LinePass(Device& device, std::uint64_t pixels);

  /// A line with an end that is no number, or 1e30 or more, is left out, and so is what is not in the picture.
  void record(CommandList& list, std::span<const SpaceLine> lines, const Camera& camera, const UVec2& size_px,
              const LineTarget& target);

 private:
  // Recordings that may be under way at a time (Frame::kInFlight): each has lines of its own.
  static constexpr std::size_t kInFlight = 3;

  Device& device_;
  std::uint64_t pixels_;
  ComputePipeline mark_, blend_;
  Buffer marks_;
  std::array<Buffer, kInFlight> lines_;
  std::size_t recordings_ = 0;
};

}  // namespace palpate
