// Poses of the frames of a recorded depth camera.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "engine/core/depth_stream.hpp"
#include "engine/core/log.hpp"
#include "engine/io/rgbd_layout.hpp"

namespace palpate {

struct StampedPose {
  double stamp = 0;  ///< seconds, or a number
  CameraPose pose;
  std::uint64_t line = 0;
  std::string lost = {};  ///< reason why it cannot be read, with the location; empty if it is valid
};

/// Sorted by stamp.
struct RgbdPoses {
  std::string from;  ///< file or folder
  bool areTimes = false;
  bool listFrames = false;  ///< whether each pose has a frame, so that one without a picture is lost
  std::vector<StampedPose> list;
};

/// The poses of a folder, whatever its layout, from the first of: `trajectory.log` (Redwood), `groundtruth.txt` (TUM),
/// `traj.txt` or `poses.txt` (16 or 12 numbers a line, as NICE-SLAM and KITTI have them), a file for each frame with a
/// matrix in `pose`, `poses` (ScanNet) or beside the pictures (`NAME.pose.txt`, 7-Scenes); empty without any. Logs
/// those that are not read. Throws FileError, with the line, for an invalid list; a file of one frame is lost.
RgbdPoses rgbdPosesOf(const std::filesystem::path& folder, Log* log);

}  // namespace palpate
