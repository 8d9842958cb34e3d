// From what the caller says about a frame to the numbers that the shaders read.
#pragma once

#include "engine/render/camera.hpp"
#include "engine/render/drawn_cloud.hpp"
#include "engine/render/frame_options.hpp"

namespace palpate {

struct FrameSize {
  std::uint32_t width, height;  ///< of the picture, pixels
  std::uint32_t supersample;    ///< samples along each side of a pixel
};

/// Tiles along each side of the largest splat on screen, as far as kMaxSplatInvocations allows; what is beyond is cut
/// off. `splatRadius` as in FrameOptions.
std::uint32_t splatTiles(const DrawnCloud& cloud, const Camera& camera, double splatRadius, std::uint32_t height_px);

shared::RenderFrame frameConstants(const DrawnCloud& cloud, const Camera& camera, const FrameOptions& options,
                                   const FrameSize& size, std::uint32_t splatTiles);

}  // namespace palpate
