// Camera intrinsics in JSON.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "engine/core/depth_stream.hpp"

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
/// column by column; optional: `depth_scale` (values per metre), `fps`, `format` and `pose`. Other keys are ignored.
/// Throws Error, without a location, for invalid cameras and for images larger than allowed.
CameraText parseCamera(std::string_view json);

/// The same from a file. Throws FileError.
CameraText readCamera(const std::filesystem::path& file);

}  // namespace palpate
