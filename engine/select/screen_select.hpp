// Selections by what a picture shows. Points are given by number, with positions relative to the cloud's origin.
#pragma once

#include "engine/render/depth_picture.hpp"
#include "engine/select/point_bits.hpp"
#include "engine/select/screen_outline.hpp"

namespace palpate {

/// Those of `among` that a picture of `size_px` shows in the outline, on the first surface or behind it.
PointBits pointsInOutline(std::span<const PointState> points, const PointBits& among, const ScreenOutline& outline,
                          const Camera& camera, const DVec2& size_px, unsigned threads = 0);

/// Those of `among` on the first surface that the picture shows: in front of its depth or at most `tolerance` (model
/// units; one to one and a half spacings of the points) behind it, allowing for the slope of the point's own surface
/// within a pixel. Points beside the picture are not; points that another surface covers are not.
///
/// At the rim of a body that is seen from outside, both sides have the same depth: there points whose normals face away
/// are left out, if the normals of nearly all other points of `among` that are seen face the eye; the other way round
/// where nearly all of these face away. Where normals are mixed or missing, depth alone decides.
PointBits firstSurface(std::span<const PointState> points, const PointBits& among, const DepthPicture& picture,
                       double tolerance, unsigned threads = 0);

}  // namespace palpate
