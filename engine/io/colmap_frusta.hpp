// Frusta and orientation of the cameras of a COLMAP model.
#pragma once

#include <optional>
#include <vector>

#include "engine/cloud/up.hpp"
#include "engine/core/camera_frustum.hpp"
#include "engine/io/colmap_model.hpp"

namespace palpate {

/// One per image, in the order of the model, model units; none for an image whose camera has no size or no plausible
/// focal length. Distortion is ignored; for a fisheye lens the angle of a corner is its distance from the principal
/// point over the focal length, limited to 75 degrees.
std::vector<CameraFrustum> frustaOf(const ColmapModel& model);

/// Up axis that the cameras agree on (upOfCameras()).
std::optional<UpAxis> upOf(const ColmapModel& model);

}  // namespace palpate
