// Cameras as lines in a picture of what they saw.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "engine/core/camera_frustum.hpp"
#include "engine/render/frame_options.hpp"
#include "haptics/session/model.hpp"

namespace palpate {

/// From a camera to the picture that stands before it, model units: half as long as the usual way to the next camera,
/// and so that it can be seen beside the model, and does not hide it.
double frustumLength(const Model& model);

/// The pyramid of a camera, with a roof over the upper edge of its picture. `origin`: of the cloud.
void addFrustum(std::vector<SpaceLine>& lines, const CameraFrustum& frustum, const DVec3& origin, double length);

/// What a picture with the cameras is to show of them and of the model: the corners of its box, and where they stand
/// but for those that are far off. Relative to the model's origin.
PointCloud placesWithCameras(const Model& model);

/// All of a model's cameras; null where it has none.
std::shared_ptr<const std::vector<SpaceLine>> cameraLines(const Model& model);

}  // namespace palpate
