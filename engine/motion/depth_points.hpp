#pragma once

#include <cstdint>
#include <vector>

#include "engine/core/cloud_frame.hpp"
#include "engine/core/depth_stream.hpp"

namespace palpate {

/// The places that the pixels of a frame see, row by row, as points in metres relative to `origin`: in the world where
/// the frame has a pose, else in the camera's axes (x right, y down, z ahead). Each with the normal that faces the
/// camera, and its colour where the frame has some. The frame's time is left to the caller.
///
/// A normal is that of the plane which fits 3 x 3 pixels, as far apart as noise demands, up to three pixels (fitReach()
/// of shaders/shared/depth_image.h, for the noise of a structured-light camera). Where not all of those lie on the
/// surface it stands upright on the way from the pixel before to the one behind, along the row and along the column
/// (central differences); where one of the two was not measured, or lies on another surface, the pixel itself stands in
/// for it; where both do, there is no normal, and no point. Another surface begins where depth jumps by more than a
/// surface can from pixel to pixel that is seen at less than 84 degrees from upright, or than a depth camera's noise.
///
/// Depths that are not positive or not finite were not measured. Of a frame of points they are the points, without
/// those that single precision does not reach. For one thread at a time, with memory that is used again for each frame.
class DepthPoints {
 public:
  /// The points do not depend on `threads` (0: one per core).
  explicit DepthPoints(unsigned threads = 1) : threads_(threads) {}

  /// Throws Error for another number of depths, or of colours, than the camera has pixels, and for more points.
  void make(const DepthCamera& camera, const DepthFrame& frame, const DVec3& origin, CloudFrame& points);
  /// Of the last frame: the pixel that each point is of, or its ray; where those are not known, its place
  /// in the frame.
  const std::vector<std::uint32_t>& pixels() const { return pixels_; }
  /// Of the last frame, whose points they are, by pixel or ray; zero where there is none.
  void normalsByPixel(const CloudFrame& points, std::size_t pixels, std::vector<Vec3>& normals) const;

 private:
  struct Part {  // of the rows
    std::vector<Vec3> positions, normals;
    std::vector<std::uint32_t> pixels;
  };
  void makeFromDepths(const DepthCamera& camera, const DepthFrame& frame, const DVec3& origin, CloudFrame& points);
  void makeFromPoints(const DepthFrame& frame, const DVec3& origin, CloudFrame& points);
  void append(const Part& part, CloudFrame& points);

  unsigned threads_;
  std::vector<Part> parts_;
  std::vector<std::uint32_t> pixels_;
};

}  // namespace palpate
