// Converts the caller's options for a frame to the constants that the shaders read.
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
/// The pixels of a picture that its overlays may cover.
PixelRectangle overlayRectangle(const Overlays& overlays, const Camera& camera, const UVec2& size_px);

/// Input of a frame, for its constants.
struct Drawn {
  Bounds bounds;
  std::uint32_t count;      ///< points or triangles
  bool hasColors;           ///< colours are summed
  double widest;            ///< longest side of a point or triangle, model units
  double splatRadius;       ///< common radius of all discs, model units; 0: each disc has its own
  double widestSplat;       ///< largest radius of a disc, model units
  double usualRadius;       ///< typical radius of discs, or deviation of triangles from the true surface, model units
  double spacing;           ///< of points, or corners of triangles, model units
  bool closeHoles;          ///< close gaps between discs
  std::uint32_t inSample;   ///< maximum number that may add up in one sample
  bool everyPoint;          ///< draw every point, however fine
  std::uint32_t shown = 0;  ///< kShown* of the points, and where it is, else 0
  std::uint32_t firstDisc = 0;  ///< points before it are particles of water
  DeviceAddress selected = 0, hidden = 0, lock = 0, values = 0;
};
Drawn drawn(const DrawnCloud& cloud, const FrameOptions& options);
Drawn drawn(const DrawnMesh& mesh);

/// Tiles along each side of the largest triangle on screen, limited by kMaxTriangleInvocations. Larger triangles are
/// walked in more rounds.
std::uint32_t tilesOf(const Drawn& drawn, const Camera& camera, std::uint32_t height_px);

shared::RenderFrame frameConstants(const Drawn& drawn, const Camera& camera, const FrameOptions& options,
                                   const FrameSize& size, std::uint32_t tiles);

}  // namespace palpate
