#include "engine/io/rgbd_list.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "engine/core/error.hpp"
#include "engine/io/camera_text.hpp"
#include "engine/io/file_start.hpp"
#include "engine/io/in_quotes.hpp"
#include "engine/io/list_lines.hpp"

#include <fmt/ranges.h>

namespace palpate {

namespace {

// Poses of the frames of a recorded depth camera.
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

/// Calls `make`, which returns a pose; an invalid one gets the location.
template <class Make>
CameraPose poseAt(const std::filesystem::path& file, std::uint64_t line, Make make) {
  try {
    return make();
  } catch (const FileError&) {
    throw;
  } catch (const Error& error) {
    throw FileError::atLine(file, line, error.what());
  }
}

/// Blocks of five lines: two numbers of the frame and one of the next frame, and the four rows of its pose.
std::vector<StampedPose> readLog(const std::filesystem::path& path) {
  ListLines lines(path);
  std::vector<StampedPose> poses;
  while (lines.next()) {
    const std::uint64_t line = lines.line();
    const auto ids = numbersIn<3>(lines.rest());
    if (!ids || !((*ids)[0] >= 0 && (*ids)[0] <= static_cast<double>(kMaxFrameNumber)))
      lines.fail(fmt::format("found {}, expected the number of a frame up to {} in front of its pose, as in \"0 0 1\"",
                             inQuotes(lines.rest()), kMaxFrameNumber));
    std::array<double, 16> rows{};
    for (std::size_t row = 0; row < 4; ++row) {
      if (!lines.next()) lines.fail(fmt::format("ends within the pose that begins in line {}", line));
      const auto numbers = numbersIn<4>(lines.rest());
      if (!numbers)
        lines.fail(fmt::format("found {}, expected the four numbers of a row of a pose", inQuotes(lines.rest())));
      std::ranges::copy(*numbers, rows.begin() + static_cast<std::ptrdiff_t>(4 * row));
    }
    poses.push_back(
        {.stamp = std::trunc((*ids)[0]), .pose = poseAt(path, line, [&] { return cameraPose(rows); }), .line = line});
  }
  return poses;
}

/// A time, a position and a quaternion a line.
std::vector<StampedPose> readTimes(const std::filesystem::path& path) {
  ListLines lines(path);
  std::vector<StampedPose> poses;
  while (lines.next()) {
    const auto numbers = numbersIn<8>(lines.rest());
    if (!numbers) lines.fail("expected eight numbers: time, tx ty tz, qx qy qz qw");
    const std::array<double, 8>& row = *numbers;  // time, position, quaternion
    if (!std::isfinite(row[0])) lines.fail("the time is not a finite number");
    const auto make = [&] { return cameraPose({row[1], row[2], row[3]}, DQuat(row[7], row[4], row[5], row[6])); };
    poses.push_back({.stamp = row[0], .pose = poseAt(path, lines.line(), make), .line = lines.line()});
  }
  return poses;
}

/// A matrix a line; the lines are counted.
std::vector<StampedPose> readRows(const std::filesystem::path& path) {
  ListLines lines(path);
  std::vector<StampedPose> poses;
  while (lines.next()) {
    std::array<double, 16> rows{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1};
    if (const auto all = numbersIn<16>(lines.rest())) {
      rows = *all;
    } else if (const auto three = numbersIn<12>(lines.rest())) {
      std::ranges::copy(*three, rows.begin());
    } else {
      lines.fail(fmt::format("found {}, expected the 16 or 12 numbers of a pose, row by row", inQuotes(lines.rest())));
    }
    const auto make = [&] { return cameraPose(rows); };
    poses.push_back(
        {.stamp = static_cast<double>(poses.size()), .pose = poseAt(path, lines.line(), make), .line = lines.line()});
  }
  return poses;
}

/// From a file with four rows.
CameraPose readMatrix(const std::filesystem::path& path) {
  ListLines lines(path);
  std::array<double, 16> rows{};
  for (std::size_t row = 0; row < 4; ++row) {
    const auto numbers = lines.next() ? numbersIn<4>(lines.rest()) : std::nullopt;
    if (!numbers) lines.fail("expected the four rows of a pose, with four numbers each");
    std::ranges::copy(*numbers, rows.begin() + static_cast<std::ptrdiff_t>(4 * row));
  }
  return poseAt(path, 1, [&] { return cameraPose(rows); });
}

struct PoseFile {
  std::string_view name;
  std::vector<StampedPose> (*read)(const std::filesystem::path&);
  bool areTimes = false, listFrames = false;
};
constexpr PoseFile kPoseFiles[]{{.name = "trajectory.log", .read = readLog, .listFrames = true},
                                {.name = "groundtruth.txt", .read = readTimes, .areTimes = true},
                                {.name = "traj.txt", .read = readRows},
                                {.name = "poses.txt", .read = readRows}};
constexpr NumberedFiles kPoseFolders[]{{.folder = "pose", .begin = "", .end = ""},
                                       {.folder = "poses", .begin = "", .end = ""},
                                       {.folder = "", .begin = "", .end = ".pose"}};

constexpr std::array<std::string_view, 1> kText{".txt"};

/// Empty for a folder without such files.
RgbdPoses posesIn(const std::filesystem::path& folder, const NumberedFiles& files) {
  std::error_code ignored;
  if (!std::filesystem::is_directory(folder / files.folder, ignored)) return {};
  const StampedFiles found = numberedFiles(folder, files, kText);
  RgbdPoses poses{.from = std::string(files.folder.empty() ? "*.pose.txt" : files.folder), .areTimes = found.areTimes};
  for (const StampedFile& file : found.files) {
    StampedPose& pose = poses.list.emplace_back(StampedPose{.stamp = file.stamp, .pose = {}});
    try {
      pose.pose = readMatrix(file.file);
    } catch (const FileError& error) {
      pose.lost = error.what();
    }
  }
  return poses;
}

/// The poses of a folder, whatever its layout, from the first of: `trajectory.log` (Redwood), `groundtruth.txt` (TUM),
/// `traj.txt` or `poses.txt` (16 or 12 numbers a line, as NICE-SLAM and KITTI have them), a file for each frame with a
/// matrix in `pose`, `poses` (ScanNet) or beside the pictures (`NAME.pose.txt`, 7-Scenes); empty without any. Logs
/// those that are not read. Throws FileError, with the line, for an invalid list; a file of one frame is lost.
RgbdPoses rgbdPosesOf(const std::filesystem::path& folder, Log* log) {
  RgbdPoses poses;
  std::vector<std::string_view> others;
  for (const PoseFile& file : kPoseFiles) {
    if (!isFile(folder / file.name)) continue;
    if (!poses.list.empty()) {
      others.push_back(file.name);
      continue;
    }
    poses = {.from = std::string(file.name),
             .areTimes = file.areTimes,
             .listFrames = file.listFrames,
             .list = file.read(folder / file.name)};
    std::ranges::stable_sort(poses.list, {}, &StampedPose::stamp);
    const auto twice = std::ranges::adjacent_find(poses.list, {}, &StampedPose::stamp);
    if (!file.areTimes && twice != poses.list.end())
      throw FileError::atLine(folder / file.name, std::next(twice)->line,
                              fmt::format("frame {} is a duplicate of line {}", twice->stamp, twice->line));
  }
  for (const NumberedFiles& files : kPoseFolders)
    if (poses.list.empty()) poses = posesIn(folder, files);
  if (!others.empty() && log)
    log->say("{}: poses are those of {}; not read: {}", folder.string(), poses.from, fmt::join(others, ", "));
  return poses;
}

constexpr double kSameMoment_s = 0.02;  // between depth and its colours
constexpr double kLongestGap_s = 1;     // between two poses: longer gaps are not interpolated
constexpr std::size_t kCandidates = 8;  // before and behind a depth: no recorded list has more within kSameMoment_s

/// For each depth the index of its colours, or none: the closest pairs up to `farthest` first, each used once (like the
/// TUM benchmark's associate.py).
std::vector<std::optional<std::size_t>> associate(const std::vector<StampedFile>& depths,
                                                  const std::vector<StampedFile>& colors, double farthest) {
  std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0; i < depths.size(); ++i) {
    const double stamp = depths[i].stamp;
    const auto behind =
        static_cast<std::size_t>(std::ranges::lower_bound(colors, stamp, {}, &StampedFile::stamp) - colors.begin());
    const std::size_t first = behind - std::min(behind, kCandidates);
    for (std::size_t k = first; k < std::min(colors.size(), behind + kCandidates); ++k)
      if (const double apart = std::abs(colors[k].stamp - stamp); apart <= farthest) pairs.emplace_back(apart, i, k);
  }
  std::ranges::sort(pairs);
  std::vector<std::optional<std::size_t>> chosen(depths.size());
  std::vector<bool> taken(colors.size());
  for (const auto& [apart, depth, color] : pairs)
    if (!chosen[depth] && !taken[color]) chosen[depth] = color, taken[color] = true;
  return chosen;
}

/// Assigns poses by order if there are as many as pictures and their numbers differ, for example if pictures start at
/// 1, or if only one of both has times.
void renumber(RgbdPoses& poses, const StampedFiles& depths) {
  if (poses.list.size() != depths.files.size() || (poses.areTimes && depths.areTimes)) return;
  for (std::size_t k = 0; k < poses.list.size(); ++k) poses.list[k].stamp = depths.files[k].stamp;
  poses.areTimes = depths.areTimes;
}

/// Pose at a stamp: nothing, or one that is lost, if there is none.
std::optional<StampedPose> poseAt(const RgbdPoses& poses, double stamp) {
  const auto behind = std::ranges::lower_bound(poses.list, stamp, {}, &StampedPose::stamp);
  if (behind == poses.list.end()) return std::nullopt;
  if (behind->stamp == stamp) return *behind;
  if (!poses.areTimes || behind == poses.list.begin()) return std::nullopt;
  const StampedPose& before = *(behind - 1);
  const double gap_s = behind->stamp - before.stamp;
  if (gap_s > kLongestGap_s) return std::nullopt;
  if (!before.lost.empty() || !behind->lost.empty()) return before.lost.empty() ? *behind : before;
  return StampedPose{.stamp = stamp, .pose = between(before.pose, behind->pose, (stamp - before.stamp) / gap_s)};
}

}  // namespace

std::vector<RgbdFiles> listFrames(const std::filesystem::path& folder, const RgbdLayout& layout, Log* log) {
  const StampedFiles depths = depthsOf(folder, layout), colors = colorsOf(folder, layout);
  RgbdPoses poses = rgbdPosesOf(folder, log);
  renumber(poses, depths);
  const bool byTime = depths.areTimes, hasColors = !colors.files.empty();  // an empty list counts as missing
  const auto chosen = associate(depths.files, colors.files, byTime ? kSameMoment_s : 0);

  struct Frame {
    double stamp;
    RgbdFiles files;
  };
  std::vector<Frame> frames;
  for (std::size_t i = 0; i < depths.files.size(); ++i) {
    const StampedFile& depth = depths.files[i];
    RgbdFiles& frame = frames.emplace_back(Frame{.stamp = depth.stamp, .files = {}}).files;
    frame.depth = depth.file;
    const auto lose = [&](std::string_view why) {
      const std::string name = depth.file.filename().string();
      frame.lost = depth.line > 0
                       ? FileError::atLine(folder / layout.list, depth.line, fmt::format("{} {}", name, why)).what()
                       : FileError(depth.file, why).what();
    };
    if (chosen[i])
      frame.color = colors.files[*chosen[i]].file;
    else if (hasColors && byTime)
      lose(fmt::format("has no colours within {} s", kSameMoment_s));
    else if (hasColors)
      lose("has no colour picture of the same number");
    if (poses.list.empty()) continue;
    if (const auto pose = poseAt(poses, depth.stamp); pose && pose->lost.empty())
      frame.pose = pose->pose;
    else if (pose)
      frame.lost = pose->lost;
    else if (byTime && poses.areTimes)
      lose(fmt::format("has no poses in {} within {} s before and after it", poses.from, kLongestGap_s));
    else
      lose(fmt::format("has no pose in {}", poses.from));
  }
  if (poses.listFrames && poses.areTimes == byTime)
    for (const StampedPose& pose : poses.list)
      if (!std::ranges::binary_search(depths.files, pose.stamp, {}, &StampedFile::stamp)) {
        const std::string why = fmt::format("frame {} has a pose but no picture of depth", pose.stamp);
        frames.push_back(
            {.stamp = pose.stamp,
             .files = {.pose = pose.pose, .lost = FileError::atLine(folder / poses.from, pose.line, why).what()}});
      }
  std::ranges::sort(frames, {}, &Frame::stamp);
  std::vector<RgbdFiles> listed;
  for (Frame& frame : frames) {
    frame.files.time_s = frame.stamp - frames.front().stamp;
    frame.files.isNumbered = !byTime;
    listed.push_back(std::move(frame.files));
  }
  return listed;
}

}  // namespace palpate
