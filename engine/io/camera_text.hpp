// Camera intrinsics in JSON or as numbers in text.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "engine/core/depth_stream.hpp"
#include "engine/io/image_file.hpp"

namespace palpate {

/// Poses of cameras, as files and programs write them.
/// From the four rows of a camera-to-world matrix. Rounding errors of the rotation are removed. Throws Error, without a
/// location, for entries that are not finite, a matrix that is not a rotation, or a last row other than 0 0 0 1.
CameraPose cameraPose(const std::array<double, 16>& rows);

/// From a position and a quaternion of unit length except for rounding. Throws Error, without a location, for others.
CameraPose cameraPose(const DVec3& centre, const DQuat& turn);

/// Interpolates between two poses: the centre linearly, the rotation along the shorter arc (Shoemake 1985).
CameraPose between(const CameraPose& from, const CameraPose& to, double share);

/// Numbers in a line, separated by blanks; nothing unless there are exactly `count` valid numbers.
template <std::size_t count>
std::optional<std::array<double, count>> numbersIn(std::string_view line);
extern template std::optional<std::array<double, 3>> numbersIn<3>(std::string_view);
extern template std::optional<std::array<double, 4>> numbersIn<4>(std::string_view);
extern template std::optional<std::array<double, 8>> numbersIn<8>(std::string_view);
extern template std::optional<std::array<double, 12>> numbersIn<12>(std::string_view);
extern template std::optional<std::array<double, 16>> numbersIn<16>(std::string_view);

/// Takes the next word (delimited by blanks) off the front of a line; empty at the end.
std::string_view takeWord(std::string_view& line);

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
