// Camera intrinsics in JSON or as numbers in text.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "engine/core/depth_stream.hpp"
#include "engine/io/image_file.hpp"

namespace palpate {

/// Depth scale if none is given: millimetres.
inline constexpr double kMillimetreDepth = 1000;
/// Depth values per metre.
inline constexpr double kMinDepthScale = 1, kMaxDepthScale = 1e6;

struct CameraText {
  DepthCamera camera;
  std::optional<double> depthScale;  ///< values per metre
  std::optional<double> rate_Hz;     ///< frames per second
  std::string format;                ///< of raw frames; may be empty
  std::optional<CameraPose> pose;    ///< from 16 numbers, the rows of a camera-to-world matrix
};

/// One object with `width`, `height`, and either `fx`, `fy`, `cx`, `cy` or Open3D's `intrinsic_matrix` of nine numbers,
/// column by column; optional: `depth_scale` (values per metre), `fps`, `format` and `pose`. Also NICE-SLAM's object
/// `camera` with `w`, `h` and `scale`. Other keys are ignored. Throws Error, without a location, for invalid cameras
/// and for images larger than allowed.
CameraText parseCamera(std::string_view json);

/// The same from a file; also from the numbers of a 3x3 or 4x4 matrix, row by row, or fx, fy, cx and cy, for pictures
/// of `size`. Throws FileError, also for a principal point beside the pictures: it is that of another camera.
CameraText readCamera(const std::filesystem::path& file, std::optional<ImageSize> size = {});

}  // namespace palpate
