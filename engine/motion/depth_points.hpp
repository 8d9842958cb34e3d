#pragma once

#include "engine/core/cloud_frame.hpp"
#include "engine/core/depth_stream.hpp"

namespace palpate {

/// The places that the pixels of a frame see, row by row, as points in metres relative to `origin`: in the world where
/// the frame has a pose, else in the camera's axes (x right, y down, z ahead). Each with the normal that faces the
/// camera, and its colour where the frame has some. Into memory that is used again; the frame's time is left to the
/// caller.
///
/// A normal stands upright on the way from the pixel before to the one behind, along the row and along the column
/// (central differences). Where one of the two was not measured, or lies on another surface, the pixel itself stands in
/// for it; where both do, there is no normal, and no point. Another surface begins where depth jumps by more than a
/// surface can from pixel to pixel that is seen at less than 84 degrees from upright, or than a depth camera's noise.
///
/// Depths that are not positive or not finite were not measured. Throws Error for another number of them, or of
/// colours, than the camera has pixels.
///
/// `pixels`, if any, says which pixel each point is of.
void makePoints(const DepthCamera& camera, const DepthFrame& frame, const DVec3& origin, CloudFrame& points,
                std::vector<std::uint32_t>* pixels = nullptr);

}  // namespace palpate
