#include "engine/io/rgbd_list.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "engine/core/error.hpp"
#include "engine/io/camera_pose.hpp"
#include "engine/io/rgbd_poses.hpp"

namespace palpate {

namespace {

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
