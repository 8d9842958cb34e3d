// Camera motion from user input: each function returns the camera after one motion. Screen positions are pixels from
// the top left corner; positions in space as in Camera.
#pragma once

#include <span>

#include "engine/render/camera.hpp"

namespace palpate {

/// Rotates the view about `pivot`, which keeps its screen position: about Camera::up by the horizontal displacement,
/// and up and down until the view is almost along up. A displacement of the picture's height rotates by 180 degrees.
Camera orbited(const Camera& camera, const DVec3& pivot, const DVec2& way_px, const DVec2& size_px);

/// Moves so that what is seen at `depth` follows the mouse.
Camera panned(const Camera& camera, double depth, const DVec2& way_px, const DVec2& size_px);

/// Moves by `way`: to the right in the picture, along Camera::up, and forward; an orthographic camera shows less.
Camera walked(const Camera& camera, const DVec3& way);

/// Moves towards `point`, which keeps its screen position, to `factor` times its distance, or shows `factor` times the
/// height if orthographic. The distance, or that height, stays between `nearest` and `farthest`.
Camera zoomed(const Camera& camera, const DVec3& point, double factor, double nearest, double farthest);

/// Orthographic, or a pinhole camera, that shows as much at the target.
Camera projecting(const Camera& camera, bool orthographic);

/// Looks at `point` from the same direction, and shows it as large as before. Twice is as once.
Camera recentred(const Camera& camera, const DVec3& point);

/// Looks at the target along `axis` (0, 1, 2: x, y, z) from its positive side if `fromAbove`, else from its negative
/// side, at the same distance. `up` is upwards in the picture; from above, `front` is at the bottom.
Camera alongAxis(const Camera& camera, int axis, bool fromAbove, UpAxis up, const DVec3& front);

/// On a smooth way through these cameras: number k at `at` == k, between the first and the last. The target and the
/// logarithm of the distance follow a spline (Catmull and Rom 1974), and so do the quaternions of the direction: a
/// camera goes around what it looks at. Where the eye moves less than the target, the eye follows a spline instead.
/// All of them are orthographic, or none is; the depth range is the first one's.
Camera alongCameras(std::span<const Camera> cameras, double at);

/// Looks at the target from that side, at the same distance. `front`: unit, from the model.
Camera fromSide(const Camera& camera, ModelSide side, UpAxis up, const DVec3& front);

}  // namespace palpate
