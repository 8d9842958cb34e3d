// Lists the frames of a folder of depth pictures, before any picture is opened.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/depth_stream.hpp"

namespace palpate {

struct RgbdFiles {
  double time_s = 0;                   ///< since the first frame
  std::filesystem::path depth, color;  ///< `color` may be empty
  std::optional<CameraPose> pose;
  std::string lost;  ///< reason why the frame is lost, with the location; empty if it may be valid
};

struct RgbdList {
  std::vector<RgbdFiles> frames;  ///< sorted by time
  double depthScale = 0;          ///< values per metre, unless the camera defines it
};

/// TUM RGB-D benchmark (Sturm et al. 2012): `depth.txt`, and optionally `rgb.txt` and `groundtruth.txt`. Colours belong
/// to the depth that is nearest in time, one to one, within 0.02 s; poses are interpolated. Throws FileError, with the
/// line, for an invalid list or duplicate times.
bool isTumFolder(const std::filesystem::path& folder);
RgbdList listTum(const std::filesystem::path& folder);

/// Redwood and Open3D (Choi, Zhou and Koltun 2015): the pictures in `depth` and in `color`, `image` or `rgb`, by the
/// first number in their names, and optionally `trajectory.log`. `rate_Hz`: frame numbers per second. Throws FileError
/// as above.
bool isRedwoodFolder(const std::filesystem::path& folder);
RgbdList listRedwood(const std::filesystem::path& folder, double rate_Hz);

}  // namespace palpate
