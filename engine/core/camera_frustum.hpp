// The field of view of a picture, to show where it was taken.
#pragma once

#include <array>

#include "engine/core/depth_stream.hpp"

namespace palpate {

/// The pyramid in front of a pinhole camera, in the coordinates of the file that names it.
struct CameraFrustum {
  DVec3 centre{0};
  /// From the centre to the corners of the picture at unit distance: upper left, upper right, lower right, lower left.
  std::array<DVec3, 4> corners{};

  bool operator==(const CameraFrustum&) const = default;
};

/// Frustum of a depth camera, metres.
inline CameraFrustum frustumOf(const DepthCamera& camera, const CameraPose& pose) {
  // The middle of the first pixel is at (0, 0), so the picture begins half a pixel before it.
  const double left = -0.5, top = -0.5, right = camera.width - 0.5, bottom = camera.height - 0.5;
  const auto corner = [&](double column, double row) { return pose.turn * camera.placeAt(column, row, 1); };
  return {.centre = pose.centre,
          .corners = {corner(left, top), corner(right, top), corner(right, bottom), corner(left, bottom)}};
}

}  // namespace palpate
