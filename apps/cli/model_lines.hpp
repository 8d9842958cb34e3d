// What is drawn in thin lines beside the points of a model: the cameras that saw it, the box that holds it.
#pragma once

#include <array>
#include <cstdint>
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

/// Of the cameras that took pictures of the model.
inline constexpr std::array<std::uint8_t, 3> kCameraColor{90, 150, 255};
/// The pyramid of a camera, with a roof over the upper edge of its picture. `origin`: of the cloud.
void addFrustum(std::vector<SpaceLine>& lines, const CameraFrustum& frustum, const DVec3& origin, double length,
                const std::array<std::uint8_t, 3>& color = kCameraColor);

/// What a picture with such lines is to show: the corners of the model's box, and where its cameras stand, if they are
/// shown, but for those that are far off. Relative to the model's origin.
PointCloud placesWithLines(const Model& model, bool cameras);

/// The edges of the box that holds the points, where there is one, and their discs.
void addContainer(std::vector<SpaceLine>& lines, const Model& model);

/// That, and all of a model's cameras where they are asked for; null where there is nothing.
std::shared_ptr<const std::vector<SpaceLine>> modelLines(const Model& model, bool cameras);

}  // namespace palpate
