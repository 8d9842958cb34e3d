// Which frames a folder of depth pictures has: what each kind of folder says of them, before any picture is opened.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/depth_stream.hpp"

namespace palpate {

struct RgbdFiles {
  double time_s = 0;                   ///< since the first frame
  std::filesystem::path depth, color;  ///< `color` is empty where there is none
  std::optional<CameraPose> pose;
  std::string lost;  ///< why it cannot be a frame, with its place; empty where it may be one
};

struct RgbdList {
  std::vector<RgbdFiles> frames;  ///< in the order of their times
  double depthScale = 0;          ///< values per metre, where the camera does not say it
};

/// Of the TUM RGB-D benchmark (Sturm et al. 2012): `depth.txt`, and `rgb.txt` and `groundtruth.txt` where it has them.
/// Colours belong to the depth that is nearest in time, one to one, within 0.02 s; poses are taken between their
/// neighbours. Throws FileError, with the line, for a list that is damaged or goes back in time.
bool isTumFolder(const std::filesystem::path& folder);
RgbdList listTum(const std::filesystem::path& folder);

/// Of Redwood and Open3D (Choi, Zhou and Koltun 2015): the pictures in `depth` and in `color`, `image` or `rgb`, by the
/// first number in their names, and `trajectory.log` where it has one. `rate_Hz`: numbers per second. Throws FileError
/// as above.
bool isRedwoodFolder(const std::filesystem::path& folder);
RgbdList listRedwood(const std::filesystem::path& folder, double rate_Hz);

}  // namespace palpate
