// What cameras are, as JSON says it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "engine/core/depth_stream.hpp"

namespace palpate {

/// What depth is where nobody says it: millimetres.
inline constexpr double kMillimetreDepth = 1000;
/// Of depth: values per metre.
inline constexpr double kMinDepthScale = 1, kMaxDepthScale = 1e6;

struct CameraText {
  DepthCamera camera;
  std::optional<double> depthScale;  ///< values per metre
  std::optional<double> rate_Hz;     ///< frames per second
  std::string format;                ///< of raw frames; empty where it is not said
  std::optional<CameraPose> pose;    ///< from 16 numbers, the rows of a matrix from the camera to the world
};

/// One object with `width`, `height`, and either `fx`, `fy`, `cx`, `cy` or Open3D's `intrinsic_matrix` of nine numbers,
/// column by column; `depth_scale` (values per metre), `fps`, `format` and `pose` where it has them. Others are
/// nobody's business here. Throws Error, without a place, for what makes no camera, or one with sides beyond those of
/// pictures.
CameraText parseCamera(std::string_view json);

/// The same from a file. Throws FileError.
CameraText readCamera(const std::filesystem::path& file);

}  // namespace palpate
