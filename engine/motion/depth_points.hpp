#pragma once

#include <cstdint>
#include <vector>

#include "engine/core/cloud_frame.hpp"
#include "engine/core/depth_stream.hpp"

namespace palpate {

/// Points that the pixels of a frame see, row by row, in metres relative to `origin`: in world coordinates if the frame
/// has a pose, else in the camera's axes (x right, y down, z ahead). Each has a normal that faces the camera, and a
/// colour if the frame has colours. The caller sets the frame's time.
///
/// A normal is that of the plane fitted to 3 x 3 pixels, spaced by up to three pixels according to the noise
/// (fitReach() of shaders/shared/depth_image.h, for a structured-light camera). Where not all of them lie on the
/// surface, it is the cross product of the central differences along row and column. A neighbour that was not measured
/// or lies on another surface is replaced by the pixel itself; without either neighbour there is no normal, and no
/// point. Another surface begins where depth jumps by more than a surface seen at less than 84 degrees from its normal
/// can from pixel to pixel, or by more than the noise.
///
/// Depths that are not positive or not finite were not measured. A frame of points gives its points, except those
/// beyond single precision. For one thread at a time; memory is reused for each frame.
class DepthPoints {
 public:
  /// The points do not depend on `threads` (0: one per core).
  explicit DepthPoints(unsigned threads = 1) : threads_(threads) {}

  /// Throws Error if the number of depths or colours differs from the number of pixels, and for too many points.
  void make(const DepthCamera& camera, const DepthFrame& frame, const DVec3& origin, CloudFrame& points);
  /// Pixel or ray of each point of the last frame; if unknown, its index in the frame.
  const std::vector<std::uint32_t>& pixels() const { return pixels_; }
  /// Normals of the last frame's `points` by pixel or ray; zero where there is no point.
  void normalsByPixel(const CloudFrame& points, std::size_t pixels, std::vector<Vec3>& normals) const;

 private:
  struct Part {  // points of some rows
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
