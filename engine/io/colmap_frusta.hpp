// What the cameras of a COLMAP model saw, and how they were held.
#pragma once

#include <optional>
#include <vector>

#include "engine/cloud/up.hpp"
#include "engine/core/camera_frustum.hpp"
#include "engine/io/colmap_model.hpp"

namespace palpate {

/// One for each image, in the order of the model, model units; none for an image whose camera has no size, or no focal
/// length that a lens has. Distortion is left out: of a fisheye lens the corners are where the angle is the distance
/// from the middle over the focal length, and 75 degrees off the view at the most.
std::vector<CameraFrustum> frustaOf(const ColmapModel& model);

/// What they agree on (upOfCameras()).
std::optional<UpAxis> upOf(const ColmapModel& model);

}  // namespace palpate
