#pragma once

#include <algorithm>
#include <vector>

#include "engine/motion/fusion.hpp"

namespace palpate {

/// Surface seen by each pixel of a frame, in single precision, as on the GPU; into memory that is reused.
void findPixelSurfaces(const FrameImages& images, const FusionOptions& options,
                       std::vector<shared::PixelSurface>& surfaces);

/// Plane fitted to the depths around a pixel, in single or double precision. Depth 0: no plane.
template <class Real>
shared::PixelSurfaceOf<Real> pixelSurface(const FrameImages& images, const shared::DepthSensorOf<Real>& sensor,
                                          int column, int row) {
  const int width = static_cast<int>(images.camera.width), height = static_cast<int>(images.camera.height);
  const auto depthAt = [&](int x, int y) {
    return static_cast<Real>(images.depths[static_cast<std::size_t>(y * std::int64_t{width} + x)]);
  };
  const Real middle = depthAt(column, row);
  if (!(middle > 0)) return {};
  const int reach = shared::fitReach(sensor, middle);
  auto sums = shared::noPixels(Real(0));
  for (int y = std::max(row - reach, 0); y <= std::min(row + reach, height - 1); ++y)
    for (int x = std::max(column - reach, 0); x <= std::min(column + reach, width - 1); ++x)
      shared::addPixel(sums, sensor, middle, glm::vec<2, Real>(x - column, y - row), depthAt(x, y));
  return shared::surfaceOf(sums, sensor, glm::vec<2, Real>(column, row), middle);
}

}  // namespace palpate
