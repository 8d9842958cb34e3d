#include "engine/io/rgbd_poses.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "engine/core/error.hpp"
#include "engine/io/camera_pose.hpp"
#include "engine/io/in_quotes.hpp"
#include "engine/io/is_file.hpp"
#include "engine/io/list_lines.hpp"

namespace palpate {

namespace {

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

}  // namespace

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

}  // namespace palpate
