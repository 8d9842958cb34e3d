#include "haptics/shared_presence.hpp"

#include <cmath>
#include <numbers>

namespace palpate {

bool isCamera(const CameraPlace& camera) {
  constexpr double kUnit = 1e-3, kMinAspect = 1e-3, kMaxAspect = 1e3;
  const DVec3& at = camera.position;
  return std::isfinite(at.x) && std::isfinite(at.y) && std::isfinite(at.z) &&
         std::abs(glm::length(camera.turn) - 1) < kUnit && camera.fovY_rad > 0 && camera.fovY_rad < std::numbers::pi &&
         camera.aspect >= kMinAspect && camera.aspect <= kMaxAspect;
}

CameraFrustum frustumOf(const CameraPlace& camera) {
  const double y = std::tan(camera.fovY_rad / 2), x = camera.aspect * y;
  return {.centre = camera.position,
          .corners = {camera.turn * DVec3(-x, -y, 1), camera.turn * DVec3(x, -y, 1), camera.turn * DVec3(x, y, 1),
                      camera.turn * DVec3(-x, y, 1)}};
}

}  // namespace palpate
