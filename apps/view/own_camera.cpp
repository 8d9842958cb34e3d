#include "apps/view/own_camera.hpp"

#include <utility>

#include "engine/render/camera_motion.hpp"
#include "haptics/sharing/ros.hpp"

namespace palpate {

CameraPlace placeOf(const Camera& camera, const DVec3& origin, double aspect) {
  const Camera::Axes axes = camera.axes();
  // Others see an orthographic camera as a pinhole camera that shows as much around its target.
  return {.position = origin + projecting(camera, false).eye,
          .turn = glm::normalize(glm::quat_cast(glm::dmat3(axes.right, -axes.up, axes.forward))),
          .fovY_rad = glm::radians(camera.fov_deg),
          .aspect = aspect};
}

OwnCamera::OwnCamera(const WindowOptions& options)
    : isHidden_(options.hidesCamera),
      ros_(options.ros.empty()
               ? nullptr
               : std::make_unique<RosCamera>(RosPublishing{.network = options.network.config(), .name = options.ros})) {
}

OwnCamera::~OwnCamera() = default;

void OwnCamera::follow(const WindowSession& session, const Camera& camera, const UVec2& size_px) {
  const Model& model = session.model();
  const CameraPlace place = placeOf(camera, model.cloud.origin, double(size_px.x) / double(size_px.y));
  // A view that is not a valid camera, e.g. with infinite coordinates, is not published.
  if (!isCamera(place)) return;
  if (model.presence() && !isHidden_) model.presence()->show(place);
  if (!ros_) return;
  try {
    ros_->show(place, model.scale.mm_per_unit);
  } catch (const NetworkError&) {
    ros_.reset();
    throw;
  }
}

}  // namespace palpate
