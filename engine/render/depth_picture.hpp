#pragma once

#include <cstdint>
#include <vector>

#include "engine/render/camera.hpp"

namespace palpate {

/// The depths of a picture of a surface, read once.
struct DepthPicture {
  std::vector<float> depths;  ///< model units, row by row from the top; 0: no surface
  std::uint32_t width = 0;    ///< pixels of a row
  double shrink = 1;          ///< each pixel covers shrink x shrink pixels of the window
  Camera camera;
  DVec2 size_px{0};  ///< of the window

  std::uint32_t height() const { return width > 0 ? static_cast<std::uint32_t>(depths.size() / width) : 0; }
  /// Depth in the pixel of the picture that contains that position of the window; 0 beside the picture.
  double depthAt(const DVec2& place_px) const { return depthOf(glm::floor(place_px / shrink)); }
  /// Depth in a pixel of the picture, by column and row; 0 beside it.
  double depthOf(const DVec2& pixel) const {
    if (!(pixel.x >= 0 && pixel.y >= 0 && pixel.x < width && pixel.y < height())) return 0;
    return static_cast<double>(depths[static_cast<std::size_t>(pixel.y) * width + static_cast<std::size_t>(pixel.x)]);
  }
};

}  // namespace palpate
