// From what the caller says about a frame to the numbers that the shaders read.
#pragma once

#include "engine/render/camera.hpp"
#include "engine/render/drawn_cloud.hpp"
#include "engine/render/drawn_mesh.hpp"
#include "engine/render/frame_options.hpp"

namespace palpate {

struct FrameSize {
  std::uint32_t width, height;  ///< of the picture, pixels
  std::uint32_t supersample;    ///< samples along each side of a pixel
};

struct PixelRectangle {
  UVec2 first_px{0}, size_px{0};
};
/// The pixels of a picture that anything may show in which is laid over the surface.
PixelRectangle overlayRectangle(const Overlays& overlays, const Camera& camera, const UVec2& size_px);

/// What a frame draws, for its constants.
struct Drawn {
  Bounds bounds;
  std::uint32_t count;  ///< points or triangles
  bool hasColors;
  double widest;           ///< on any side of one of them, model units
  double splatRadius;      ///< of every disc, model units; 0: each has its own
  double widestSplat;      ///< radius of a disc at most, model units
  double usualRadius;      ///< of discs, or how far triangles may stand off the true surface, model units
  bool closeHoles;         ///< there may be gaps between them
  std::uint32_t inSample;  ///< how many may add up in one sample
  bool everyPoint;         ///< however fine they are
};
Drawn drawn(const DrawnCloud& cloud, const FrameOptions& options);
Drawn drawn(const DrawnMesh& mesh);

/// Tiles along each side of the largest triangle on screen, as far as kMaxTriangleInvocations allows. Larger ones are
/// walked in more rounds.
std::uint32_t tilesOf(const Drawn& drawn, const Camera& camera, std::uint32_t height_px);

shared::RenderFrame frameConstants(const Drawn& drawn, const Camera& camera, const FrameOptions& options,
                                   const FrameSize& size, std::uint32_t tiles);

}  // namespace palpate
