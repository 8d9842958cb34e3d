// Lists the frames of a folder of depth pictures, before any picture is opened.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/depth_stream.hpp"
#include "engine/core/log.hpp"
#include "engine/io/rgbd_layout.hpp"

namespace palpate {

struct RgbdFiles {
  double time_s = 0;  ///< since the first frame; of numbered ones, the number of frames since then
  bool isNumbered = false;
  std::filesystem::path depth, color;  ///< `color` may be empty
  std::optional<CameraPose> pose;
  std::string lost;  ///< reason why the frame is lost, with the location; empty if it may be valid
};

/// Sorted by time. Pictures and poses of the same number belong together; if they are named by times, colours belong to
/// the depth that is nearest in time, one to one, within 0.02 s, and poses are interpolated. Poses whose numbers are
/// others, but as many, belong to the pictures in order. Throws FileError, with the line, for an invalid list or
/// duplicates.
std::vector<RgbdFiles> listFrames(const std::filesystem::path& folder, const RgbdLayout& layout, Log* log);

}  // namespace palpate
