#include <algorithm>
#include <cctype>
#include <map>

#include "engine/core/error.hpp"
#include "engine/io/camera_pose.hpp"
#include "engine/io/camera_text.hpp"
#include "engine/io/chunked_file.hpp"
#include "engine/io/in_quotes.hpp"
#include "engine/io/rgbd_list.hpp"
#include "engine/io/text_number.hpp"

namespace palpate {

namespace {

constexpr std::size_t kMaxLogLine = std::size_t{1} << 16;
constexpr std::uint64_t kMaxNumber = 100'000'000;  // of a frame: months at 30 Hz

using Pictures = std::map<std::uint64_t, std::filesystem::path>;  // by number
struct LoggedPose {
  CameraPose pose;
  std::uint64_t line = 0;
};
using Poses = std::map<std::uint64_t, LoggedPose>;

bool isFolder(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::is_directory(path, ignored);
}

bool isPicture(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ending == ".png" || ending == ".jpg" || ending == ".jpeg";
}

/// The first number in a name.
std::optional<std::uint64_t> numberIn(std::string_view name) {
  const auto isDigit = [](char c) { return c >= '0' && c <= '9'; };
  const auto begin = std::ranges::find_if(name, isDigit);
  const auto end = std::find_if_not(begin, name.end(), isDigit);
  return textNumber<std::uint64_t>({begin, end});
}

Pictures picturesIn(const std::filesystem::path& folder) {
  Pictures pictures;
  std::error_code error;
  for (auto entry = std::filesystem::directory_iterator(folder, error);
       !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
    if (!isPicture(entry->path())) continue;
    const auto number = numberIn(entry->path().stem().string());
    if (!number || *number > kMaxNumber)
      throw FileError(entry->path(), fmt::format("has no number up to {} in its name; pictures are in the order of "
                                                 "their numbers",
                                                 kMaxNumber));
    const auto [found, isNew] = pictures.emplace(*number, entry->path());
    if (!isNew)
      throw FileError(entry->path(),
                      fmt::format("has the same number as {}; remove one of them", found->second.filename().string()));
  }
  if (error) throw FileError(folder, fmt::format("cannot be read: {}", error.message()));
  return pictures;
}

/// Blocks of five lines: two numbers of the frame and one of the next frame, and the four rows of its pose.
Poses readLog(const std::filesystem::path& path) {
  ChunkedFile file(path);
  Poses poses;
  const auto fail = [&](std::string_view what) { throw FileError::atLine(path, file.line(), what); };
  const auto next = [&] {
    auto line = file.readLine(kMaxLogLine);
    while (line && line->find_first_not_of(" \t\r") == line->npos) line = file.readLine(kMaxLogLine);
    return line;
  };
  while (const auto head = next()) {
    const std::uint64_t line = file.line();
    const auto ids = numbersIn<3>(*head);
    if (!ids || !((*ids)[0] >= 0 && (*ids)[0] <= static_cast<double>(kMaxNumber)))
      fail(fmt::format("found {}, expected the number of a frame up to {} in front of its pose, as in \"0 0 1\"",
                       inQuotes(*head), kMaxNumber));
    std::array<double, 16> rows{};
    for (std::size_t row = 0; row < 4; ++row) {
      const auto text = next();
      if (!text) fail(fmt::format("ends within the pose that begins in line {}", line));
      const auto numbers = numbersIn<4>(*text);
      if (!numbers) fail(fmt::format("found {}, expected the four numbers of a row of a pose", inQuotes(*text)));
      std::ranges::copy(*numbers, rows.begin() + static_cast<std::ptrdiff_t>(4 * row));
    }
    const auto number = static_cast<std::uint64_t>((*ids)[0]);
    if (const auto before = poses.find(number); before != poses.end())
      throw FileError::atLine(path, line,
                              fmt::format("frame {} is a duplicate of line {}", number, before->second.line));
    try {
      poses.emplace(number, LoggedPose{.pose = cameraPose(rows), .line = line});
    } catch (const Error& error) {
      throw FileError::atLine(path, line, error.what());
    }
  }
  return poses;
}

/// Assigns poses by order if there are as many as pictures and their numbers differ, for example if pictures start at
/// 1.
Poses renumbered(Poses poses, const Pictures& depths) {
  const auto sameNumber = [](const auto& a, const auto& b) { return a.first == b.first; };
  if (poses.size() != depths.size() || std::ranges::equal(poses, depths, sameNumber)) return poses;
  Poses renumbered;
  auto depth = depths.begin();
  for (const auto& [number, pose] : poses) renumbered.emplace((depth++)->first, pose);
  return renumbered;
}

}  // namespace

bool isRedwoodFolder(const std::filesystem::path& folder) { return isFolder(folder / "depth"); }

RgbdList listRedwood(const std::filesystem::path& folder, double rate_Hz) {
  const Pictures depths = picturesIn(folder / "depth");
  if (depths.empty()) throw FileError(folder / "depth", "has no pictures");
  Pictures colors;
  for (const char* name : {"color", "image", "rgb"})
    if (colors.empty() && isFolder(folder / name)) colors = picturesIn(folder / name);
  const std::filesystem::path log = folder / "trajectory.log";
  std::error_code ignored;
  const Poses poses = std::filesystem::exists(log, ignored) ? renumbered(readLog(log), depths) : Poses{};
  const bool hasPoses = !poses.empty();  // an empty list counts as missing

  // Every number with a picture or a pose is a frame.
  std::map<std::uint64_t, RgbdFiles> frames;
  for (const auto& [number, depth] : depths) frames[number].depth = depth;
  for (const auto& [number, pose] : poses) frames[number].pose = pose.pose;
  RgbdList made{.frames = {}, .depthScale = kMillimetreDepth};
  for (auto& [number, frame] : frames) {
    frame.time_s = static_cast<double>(number - frames.begin()->first) / rate_Hz;
    const auto color = colors.find(number);
    if (color != colors.end()) frame.color = color->second;
    if (frame.depth.empty())
      frame.lost = FileError::atLine(log, poses.at(number).line,
                                     fmt::format("frame {} has a pose but no picture in depth", number))
                       .what();
    else if (hasPoses && !frame.pose)
      frame.lost = FileError(frame.depth, "has no pose in trajectory.log").what();
    else if (!colors.empty() && frame.color.empty())
      frame.lost = FileError(frame.depth, "has no colour picture of the same number").what();
    made.frames.push_back(std::move(frame));
  }
  return made;
}

}  // namespace palpate
