#include "apps/view/camera_drag.hpp"

#include <algorithm>

#include "engine/render/camera_motion.hpp"

namespace palpate {

void CameraDrag::begin(const Camera& camera, const DVec3& pivot, bool pans) {
  pivot_ = pivot;
  depth_ = std::max(glm::dot(pivot - camera.eye, camera.axes().forward), camera.nearDepth);
  kind_ = pans ? Kind::pan : Kind::orbit;
}

Camera CameraDrag::moved(const Camera& camera, const DVec2& way_px, const DVec2& size_px) const {
  if (kind_ == Kind::orbit) return orbited(camera, pivot_, way_px, size_px);
  if (kind_ == Kind::pan) return panned(camera, depth_, way_px, size_px);
  constexpr double kHalfTurn_deg = 180;  // orbited() makes one by the picture's height: the picture follows the mouse
  if (kind_ == Kind::turn) return orbited(camera, camera.eye, -camera.fov_deg / kHalfTurn_deg * way_px, size_px);
  return camera;
}

bool CameraDrag::isDoubleClick(double time_s, const DVec2& place_px) const {
  constexpr double kDoubleClick_s = 0.35, kDoubleClick_px = 6;
  return time_s - clicked_s_ < kDoubleClick_s && glm::distance(clicked_px_, place_px) < kDoubleClick_px;
}

void CameraDrag::noteClick(double time_s, const DVec2& place_px) {
  clicked_px_ = place_px;
  clicked_s_ = time_s;
}

}  // namespace palpate
