// Pictures of depth of ROS, and the camera that takes them: where what a foreign program says of them is looked at.
// Nothing of DDS is seen here.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/depth_stream.hpp"

namespace palpate {

/// An Image as it came, of which nothing has been looked at. What it refers to outlives it.
struct RosPicture {
  std::uint32_t height = 0, width = 0;
  std::string_view encoding;
  bool isBigEndian = false;
  std::uint32_t step = 0;  ///< bytes of a row
  std::span<const std::uint8_t> data;
};

/// A CameraInfo as it came.
struct RosCalibration {
  std::uint32_t height = 0, width = 0;
  std::string_view distortion;               ///< name of its model
  std::span<const double> d;                 ///< its parameters
  std::array<double, 9> k{};                 ///< of pictures as they are taken: fx 0 cx, 0 fy cy, 0 0 1
  std::array<double, 12> p{};                ///< of rectified ones, likewise, each row with one number more
  std::uint32_t binningX = 0, binningY = 0;  ///< 0 and 1: none
  bool isPart = false;                       ///< a region of interest, and not all of the picture
};

/// The topic of the camera beside one of pictures, as ROS names it: "a/camera_info" of "a/image_raw".
std::string rosCameraTopic(const std::string& pictures);
/// Whether pictures of that topic are rectified, as ROS names it: it is called image_rect, image_rect_raw and so on.
bool isRectified(const std::string& pictures);

/// Throws NetworkError in words where it makes no camera, or one whose lens distorts: only rectified pictures are
/// without.
DepthCamera rosCamera(const RosCalibration& calibration, bool isRectified);

/// Depths of a picture of 16UC1 and mono16 (millimetres), or 32FC1 (metres), in either order of bytes; 0 where none was
/// measured, which is said by 0, NaN, or infinity. `depthScale`: values per metre in place of those; 0: those. Throws
/// NetworkError where the picture contradicts itself, or is of another size than the camera's.
void takeRosDepths(const RosPicture& picture, const DepthCamera& camera, double depthScale,
                   std::vector<float>& depth_m);

/// Colours of a picture of rgb8 or bgr8 that is registered with one of depth: of the same pixels. Throws NetworkError
/// as takeRosDepths().
void takeRosColors(const RosPicture& picture, const DepthCamera& camera,
                   std::vector<std::array<std::uint8_t, 3>>& colors);

/// Times of frames, of stamps that may stand still, go back, or leap: those go on with the clock here instead.
class RosFrameTimes {
 public:
  /// Since the first one; each later than the one before.
  double timeOf(std::int64_t stamp_ns, double arrived_s);

 private:
  bool hasBegun_ = false;
  std::int64_t stamp_ns_ = 0;
  double arrived_s_ = 0, time_s_ = 0;
};

}  // namespace palpate
