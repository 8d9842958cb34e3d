#include <algorithm>
#include <cmath>
#include <tuple>

#include "engine/core/error.hpp"
#include "engine/io/camera_pose.hpp"
#include "engine/io/chunked_file.hpp"
#include "engine/io/in_quotes.hpp"
#include "engine/io/is_file.hpp"
#include "engine/io/rgbd_list.hpp"
#include "engine/io/text_number.hpp"

namespace palpate {

namespace {

constexpr std::size_t kMaxListLine = std::size_t{1} << 16;
constexpr double kDepthScale = 5000;
constexpr double kSameMoment_s = 0.02;  // between depth and its colours
constexpr double kLongestGap_s = 1;     // between two poses: longer gaps are not interpolated
constexpr std::size_t kCandidates = 8;  // before and behind a depth: no recorded list has more within kSameMoment_s

struct Stamped {
  double stamp_s = 0;
  std::filesystem::path file;
  std::uint64_t line = 0;
};
struct StampedPose {
  double stamp_s = 0;
  CameraPose pose;
};

/// The lines of a list that are not blank or comments.
class Lines {
 public:
  explicit Lines(const std::filesystem::path& path) : file_(path) {}

  bool next() {
    do {
      const auto line = file_.readLine(kMaxListLine);
      if (!line) return false;
      rest_ = *line;
      const std::size_t begin = rest_.find_first_not_of(" \t\r");
      rest_.remove_prefix(std::min(begin, rest_.size()));
    } while (rest_.empty() || rest_.front() == '#');
    return true;
  }
  std::string_view& rest() { return rest_; }
  std::uint64_t line() const { return file_.line(); }
  [[noreturn]] void fail(std::string_view what) const { throw FileError::atLine(file_.path(), line(), what); }

 private:
  ChunkedFile file_;
  std::string_view rest_;
};

/// Sorted by time, independent of the order in the list.
std::vector<Stamped> readFiles(const std::filesystem::path& folder, const char* name) {
  Lines lines(folder / name);
  std::vector<Stamped> files;
  while (lines.next()) {
    const std::string_view stamp = takeWord(lines.rest());
    const auto stamp_s = textNumber<double>(stamp);
    if (!stamp_s || !std::isfinite(*stamp_s))
      lines.fail(fmt::format("found {}, expected a time in seconds and the name of a picture", inQuotes(stamp)));
    const std::string_view file = takeWord(lines.rest());
    if (file.empty() || !takeWord(lines.rest()).empty())
      lines.fail("expected a time in seconds and the name of a picture");
    files.push_back({.stamp_s = *stamp_s, .file = folder / std::string(file), .line = lines.line()});
  }
  std::ranges::stable_sort(files, {}, &Stamped::stamp_s);
  const auto twice = std::ranges::adjacent_find(files, {}, &Stamped::stamp_s);
  if (twice != files.end())
    throw FileError::atLine(folder / name, std::next(twice)->line,
                            fmt::format("time {} s is a duplicate of line {}", twice->stamp_s, twice->line));
  return files;
}

/// Sorted by time, independent of the order in the file.
std::vector<StampedPose> readPoses(const std::filesystem::path& path) {
  Lines lines(path);
  std::vector<StampedPose> poses;
  while (lines.next()) {
    const auto numbers = numbersIn<8>(lines.rest());
    if (!numbers) lines.fail("expected eight numbers: time, tx ty tz, qx qy qz qw");
    const auto& [stamp_s, x, y, z, qx, qy, qz, qw] = *numbers;
    if (!std::isfinite(stamp_s)) lines.fail("the time is not a finite number");
    try {
      poses.push_back({.stamp_s = stamp_s, .pose = cameraPose({x, y, z}, DQuat(qw, qx, qy, qz))});
    } catch (const FileError&) {
      throw;
    } catch (const Error& error) {
      lines.fail(error.what());
    }
  }
  std::ranges::stable_sort(poses, {}, &StampedPose::stamp_s);
  return poses;
}

/// For each depth the index of its colours, or none: the closest pairs first, each used once (like the benchmark's
/// associate.py).
std::vector<std::optional<std::size_t>> associate(const std::vector<Stamped>& depths,
                                                  const std::vector<Stamped>& colors) {
  std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0; i < depths.size(); ++i) {
    const double stamp_s = depths[i].stamp_s;
    const auto behind =
        static_cast<std::size_t>(std::ranges::lower_bound(colors, stamp_s, {}, &Stamped::stamp_s) - colors.begin());
    const std::size_t first = behind - std::min(behind, kCandidates);
    for (std::size_t k = first; k < std::min(colors.size(), behind + kCandidates); ++k)
      if (const double apart_s = std::abs(colors[k].stamp_s - stamp_s); apart_s < kSameMoment_s)
        pairs.emplace_back(apart_s, i, k);
  }
  std::ranges::sort(pairs);
  std::vector<std::optional<std::size_t>> chosen(depths.size());
  std::vector<bool> taken(colors.size());
  for (const auto& [apart_s, depth, color] : pairs)
    if (!chosen[depth] && !taken[color]) chosen[depth] = color, taken[color] = true;
  return chosen;
}

std::optional<CameraPose> poseAt(const std::vector<StampedPose>& poses, double stamp_s) {
  const auto behind = std::ranges::lower_bound(poses, stamp_s, {}, &StampedPose::stamp_s);
  if (behind == poses.end()) return std::nullopt;
  if (behind->stamp_s == stamp_s) return behind->pose;
  if (behind == poses.begin()) return std::nullopt;
  const StampedPose& before = *(behind - 1);
  const double gap_s = behind->stamp_s - before.stamp_s;
  if (gap_s > kLongestGap_s) return std::nullopt;
  return between(before.pose, behind->pose, (stamp_s - before.stamp_s) / gap_s);
}

}  // namespace

bool isTumFolder(const std::filesystem::path& folder) { return isFile(folder / "depth.txt"); }

RgbdList listTum(const std::filesystem::path& folder) {
  const std::filesystem::path list = folder / "depth.txt", poseList = folder / "groundtruth.txt";
  const std::vector<Stamped> depths = readFiles(folder, "depth.txt");
  if (depths.empty()) throw FileError(list, "lists no pictures");
  const auto colors = isFile(folder / "rgb.txt") ? readFiles(folder, "rgb.txt") : std::vector<Stamped>{};
  const auto poses = isFile(poseList) ? readPoses(poseList) : std::vector<StampedPose>{};
  const bool hasColors = !colors.empty(), hasPoses = !poses.empty();  // an empty list counts as missing
  const auto chosen = associate(depths, colors);

  RgbdList made{.frames = {}, .depthScale = kDepthScale};
  for (std::size_t i = 0; i < depths.size(); ++i) {
    const Stamped& depth = depths[i];
    RgbdFiles& frame = made.frames.emplace_back();
    frame.time_s = depth.stamp_s - depths.front().stamp_s;
    frame.depth = depth.file;
    if (chosen[i]) frame.color = colors[*chosen[i]].file;
    if (hasPoses) frame.pose = poseAt(poses, depth.stamp_s);
    const auto lose = [&](std::string_view why) { frame.lost = FileError::atLine(list, depth.line, why).what(); };
    if (hasColors && !chosen[i])
      lose(fmt::format("{} has no colours in rgb.txt within {} s", depth.file.filename().string(), kSameMoment_s));
    else if (hasPoses && !frame.pose)
      lose(fmt::format("{} has no poses in groundtruth.txt within {} s before and after it",
                       depth.file.filename().string(), kLongestGap_s));
  }
  return made;
}

}  // namespace palpate
