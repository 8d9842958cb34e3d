// Depth images of ROS and the camera that takes them; messages of foreign programs are validated here. Independent of
// DDS.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/depth_stream.hpp"

namespace palpate {

/// An Image as received, not validated yet. What it refers to must outlive it.
struct RosPicture {
  std::uint32_t height = 0, width = 0;
  std::string_view encoding;
  bool isBigEndian = false;
  std::uint32_t step = 0;  ///< bytes per row
  std::span<const std::uint8_t> data;
};

/// A CameraInfo as received.
struct RosCalibration {
  std::uint32_t height = 0, width = 0;
  std::string_view distortion;               ///< name of its model
  std::span<const double> d;                 ///< its parameters
  std::array<double, 9> k{};                 ///< of raw images: fx 0 cx, 0 fy cy, 0 0 1
  std::array<double, 12> p{};                ///< of rectified images, likewise, each row with one more number
  std::uint32_t binningX = 0, binningY = 0;  ///< 0 and 1: none
  bool isPart = false;                       ///< a region of interest, not the whole image
};

/// The topic of the CameraInfo beside a topic of images, as ROS names it: "a/camera_info" for "a/image_raw".
std::string rosCameraTopic(const std::string& pictures);
/// Whether images of that topic are rectified, as ROS names it: image_rect, image_rect_raw and so on.
bool isRectified(const std::string& pictures);

/// Throws NetworkError if the calibration is invalid, or if the lens distorts and the images are not rectified.
DepthCamera rosCamera(const RosCalibration& calibration, bool isRectified);

/// Depths of an image of 16UC1 or mono16 (millimetres), or 32FC1 (metres), in either byte order; 0 where none was
/// measured (0, NaN, or infinity). `depthScale`: values per metre; 0: as encoded. Throws NetworkError if the image
/// contradicts itself, or its size differs from the camera's.
void takeRosDepths(const RosPicture& picture, const DepthCamera& camera, double depthScale,
                   std::vector<float>& depth_m);

/// Colours of an image of rgb8 or bgr8 that is registered to a depth image: of the same pixels. Throws NetworkError as
/// takeRosDepths().
void takeRosColors(const RosPicture& picture, const DepthCamera& camera,
                   std::vector<std::array<std::uint8_t, 3>>& colors);

/// Times of frames, from stamps that may repeat, go back or leap: the local clock is used instead of those.
class RosFrameTimes {
 public:
  /// Time since the first frame; strictly increasing.
  double timeOf(std::int64_t stamp_ns, double arrived_s);

 private:
  bool hasBegun_ = false;
  std::int64_t stamp_ns_ = 0;
  double arrived_s_ = 0, time_s_ = 0;
};

}  // namespace palpate
