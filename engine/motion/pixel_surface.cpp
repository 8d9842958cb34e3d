#include "engine/motion/pixel_surface.hpp"

#include "engine/core/parallel.hpp"

namespace palpate {

void findPixelSurfaces(const FrameImages& images, const FusionOptions& options,
                       std::vector<shared::PixelSurface>& surfaces) {
  const shared::DepthSensor sensor = sensorOf(images.camera, options);
  surfaces.resize(images.depths.size());
  parallelFor(surfaces.size(), options.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t pixel = begin; pixel < end; ++pixel)
      surfaces[pixel] = pixelSurface(images, sensor, static_cast<int>(pixel % images.camera.width),
                                     static_cast<int>(pixel / images.camera.width));
  });
}

}  // namespace palpate
