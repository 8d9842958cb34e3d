// Thin lines beside the points of a model: the cameras that saw it, the box that holds it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/core/camera_frustum.hpp"
#include "engine/render/frame_options.hpp"
#include "haptics/session/model.hpp"

namespace palpate {

/// Distance of a camera's drawn picture from its centre, model units: half the typical distance to the next camera,
/// within bounds so that it is visible beside the model and does not hide it.
double frustumLength(const Model& model);

/// Colour of the cameras that took pictures of the model.
inline constexpr std::array<std::uint8_t, 3> kCameraColor{90, 150, 255};
/// The pyramid of a camera, with a roof over the upper edge of its picture. `origin`: of the cloud.
void addFrustum(std::vector<SpaceLine>& lines, const CameraFrustum& frustum, const DVec3& origin, double length,
                const std::array<std::uint8_t, 3>& color = kCameraColor);

/// Positions that a picture with such lines is to show: the corners of the model's box, and its cameras if they are
/// shown and not far off. Relative to the model's origin.
PointCloud placesWithLines(const Model& model, bool cameras);

/// Adds the edges of the box that holds the points and their discs, if there is one.
void addContainer(std::vector<SpaceLine>& lines, const Model& model);

/// The box, and on request all cameras of the model.
std::vector<SpaceLine> modelLines(const Model& model, bool cameras);

}  // namespace palpate
