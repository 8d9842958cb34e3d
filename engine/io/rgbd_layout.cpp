#include "engine/io/rgbd_layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>

#include "engine/core/error.hpp"
#include "engine/io/camera_text.hpp"
#include "engine/io/file_start.hpp"
#include "engine/io/in_quotes.hpp"
#include "engine/io/list_lines.hpp"
#include "engine/io/text_number.hpp"

namespace palpate {

namespace {

constexpr double kTumScale = 5000;
/// PrimeSense camera, as assumed by the TUM benchmark and Open3D without calibration.
constexpr DepthCamera kPrimeSense{.width = 640, .height = 480, .fx = 525, .fy = 525, .cx = 319.5, .cy = 239.5};
constexpr DepthCamera kReplicaCamera{.width = 1200, .height = 680, .fx = 600, .fy = 600, .cx = 599.5, .cy = 339.5};
constexpr DepthCamera kSevenScenesCamera{.width = 640, .height = 480, .fx = 585, .fy = 585, .cx = 320, .cy = 240};
constexpr std::array<NumberedFiles, 3> kColorFolders{{{.folder = "color"}, {.folder = "image"}, {.folder = "rgb"}}};

/// In this order: the first one that fits a folder counts.
constexpr RgbdLayout kLayouts[]{
    // RGB-D benchmark of the TUM (Sturm et al. 2012), with its lists or without them.
    {.name = "TUM",
     .sign = "depth.txt or depth/TIME.png",
     .list = "depth.txt",
     .colorList = "rgb.txt",
     .namesHaveDecimals = true,
     .depth = {.folder = "depth"},
     .colors = kColorFolders,
     .depthScale = kTumScale,
     .usualCamera = kPrimeSense},
    // Dai et al. 2017, as its reader exports a scan.
    {.name = "ScanNet",
     .sign = "depth/ and pose/",
     .beside = "pose",
     .depth = {.folder = "depth"},
     .colors = kColorFolders,
     .depthScale = kMillimetreDepth,
     .usualCamera = kPrimeSense},
    // Redwood and Open3D (Choi, Zhou and Koltun 2015).
    {.name = "Redwood",
     .sign = "depth/",
     .depth = {.folder = "depth"},
     .colors = kColorFolders,
     .depthScale = kMillimetreDepth,
     .usualCamera = kPrimeSense},
    // Straub et al. 2019, as rendered for NICE-SLAM (Zhu et al. 2022).
    {.name = "Replica",
     .sign = "results/depthN.png",
     .depth = {.folder = "results", .begin = "depth"},
     .colors = {{{.folder = "results", .begin = "frame"}}},
     .depthScale = 6553.5,
     .usualCamera = kReplicaCamera},
    // Shotton et al. 2013; 3DMatch has the same names.
    {.name = "7-Scenes",
     .sign = "frame-N.depth.png",
     .depth = {.folder = "", .begin = "", .end = ".depth"},
     .colors = {{{.folder = "", .begin = "", .end = ".color"}}},
     .depthScale = kMillimetreDepth,
     .usualCamera = kSevenScenesCamera},
};

constexpr std::array<std::string_view, 3> kPictureEndings{".png", ".jpg", ".jpeg"};

bool isFolder(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::is_directory(path, ignored);
}

std::string lowerEndingOf(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ending;
}

bool isDigit(char c) { return c >= '0' && c <= '9'; }

struct Stamp {
  double value = 0;
  bool isTime = false, hasDecimals = false;
};

/// Seconds of a whole number that counts from 1970.
std::optional<double> epoch_s(std::uint64_t number) {
  constexpr double kBegin_s = 1e9, kEnd_s = 1e10;  // 2001 to 2286
  for (const double perSecond : {1.0, 1e3, 1e6, 1e9}) {
    const double time_s = static_cast<double>(number) / perSecond;
    if (time_s >= kBegin_s && time_s < kEnd_s) return time_s;
  }
  return std::nullopt;
}

/// Of the first number in a name.
std::optional<Stamp> stampIn(std::string_view name) {
  const auto begin = std::ranges::find_if(name, isDigit);
  auto end = std::find_if_not(begin, name.end(), isDigit);
  const auto whole = textNumber<std::uint64_t>({begin, end});
  if (!whole) return std::nullopt;
  if (end - name.begin() + 1 < std::ssize(name) && *end == '.' && isDigit(*(end + 1))) {
    end = std::find_if_not(end + 1, name.end(), isDigit);
    return Stamp{.value = *textNumber<double>({begin, end}), .isTime = true, .hasDecimals = true};
  }
  if (*whole <= kMaxFrameNumber) return Stamp{.value = static_cast<double>(*whole)};
  const auto time_s = epoch_s(*whole);
  return time_s ? std::optional(Stamp{.value = *time_s, .isTime = true}) : std::nullopt;
}

bool isAmong(const std::filesystem::path& file, const NumberedFiles& files, std::span<const std::string_view> endings) {
  const std::string stem = file.stem().string();
  return stem.size() >= files.begin.size() + files.end.size() && stem.starts_with(files.begin) &&
         stem.ends_with(files.end) && std::ranges::find(endings, lowerEndingOf(file)) != endings.end();
}

/// Calls `visit` with each file until it returns false.
template <class Visit>
void visitFiles(const std::filesystem::path& folder, Visit visit) {
  std::error_code error;
  for (auto entry = std::filesystem::directory_iterator(folder, error);
       !error && entry != std::filesystem::directory_iterator(); entry.increment(error))
    if (!visit(entry->path())) return;
  if (error) throw FileError(folder, fmt::format("cannot be read: {}", error.message()));
}

bool hasPictures(const std::filesystem::path& folder, const RgbdLayout& layout) {
  constexpr int kMaxFiles = 1000;  // that are looked at
  int seen = 0;
  bool found = false;
  try {
    visitFiles(folder / layout.depth.folder, [&](const std::filesystem::path& file) {
      if (isAmong(file, layout.depth, kPictureEndings)) {
        const auto stamp = stampIn(file.stem().string());
        found = !layout.namesHaveDecimals || (stamp && stamp->hasDecimals);
      }
      return !found && ++seen < kMaxFiles;
    });
  } catch (const FileError&) {
    return false;
  }
  return found;
}

bool hasList(const std::filesystem::path& folder, const RgbdLayout& layout) {
  return !layout.list.empty() && isFile(folder / layout.list);
}

bool fits(const std::filesystem::path& folder, const RgbdLayout& layout) {
  if (hasList(folder, layout)) return true;
  if (!layout.beside.empty() && !isFolder(folder / layout.beside)) return false;
  if (!isFolder(folder / layout.depth.folder)) return false;
  const bool namesTell = layout.namesHaveDecimals || !layout.depth.begin.empty() || !layout.depth.end.empty();
  return !namesTell || hasPictures(folder, layout);
}

/// Sorted by time, independent of the order in the list.
StampedFiles listedFiles(const std::filesystem::path& folder, std::string_view name) {
  ListLines lines(folder / name);
  StampedFiles listed{.files = {}, .areTimes = true};
  while (lines.next()) {
    const std::string_view stamp = takeWord(lines.rest());
    const auto stamp_s = textNumber<double>(stamp);
    if (!stamp_s || !std::isfinite(*stamp_s))
      lines.fail(fmt::format("found {}, expected a time in seconds and the name of a picture", inQuotes(stamp)));
    const std::string_view file = takeWord(lines.rest());
    if (file.empty() || !takeWord(lines.rest()).empty())
      lines.fail("expected a time in seconds and the name of a picture");
    listed.files.push_back({.stamp = *stamp_s, .file = folder / std::string(file), .line = lines.line()});
  }
  std::ranges::stable_sort(listed.files, {}, &StampedFile::stamp);
  const auto twice = std::ranges::adjacent_find(listed.files, {}, &StampedFile::stamp);
  if (twice != listed.files.end())
    throw FileError::atLine(folder / name, std::next(twice)->line,
                            fmt::format("time {} s is a duplicate of line {}", twice->stamp, twice->line));
  return listed;
}

}  // namespace

const RgbdLayout* rgbdLayoutOf(const std::filesystem::path& folder) {
  const auto found = std::ranges::find_if(kLayouts, [&](const RgbdLayout& layout) { return fits(folder, layout); });
  return found == std::end(kLayouts) ? nullptr : found;
}

std::string rgbdLayoutsRead(bool withSigns) {
  std::string list;
  for (const RgbdLayout& layout : kLayouts) {
    const bool isLast = &layout == std::end(kLayouts) - 1;
    if (!list.empty()) list += isLast ? " or " : ", ";
    list += layout.name;
    if (withSigns) list += fmt::format(" ({})", layout.sign);
  }
  return list;
}

StampedFiles numberedFiles(const std::filesystem::path& folder, const NumberedFiles& files,
                           std::span<const std::string_view> endings) {
  StampedFiles found;
  std::size_t times = 0;
  visitFiles(folder / files.folder, [&](const std::filesystem::path& file) {
    if (!isAmong(file, files, endings)) return true;
    std::string stem = file.stem().string();
    stem = stem.substr(files.begin.size(), stem.size() - files.begin.size() - files.end.size());
    const auto stamp = stampIn(stem);
    if (!stamp)
      throw FileError(file, fmt::format("has no number up to {} and no time in its name; pictures are in the order of "
                                        "their numbers or times",
                                        kMaxFrameNumber));
    times += stamp->isTime;
    found.files.push_back({.stamp = stamp->value, .file = file});
    return true;
  });
  if (times > 0 && times < found.files.size())
    throw FileError(folder / files.folder, fmt::format("{} of its {} files are named by a time, the others by a number",
                                                       times, found.files.size()));
  found.areTimes = times > 0;
  std::ranges::sort(found.files, {}, [](const StampedFile& file) { return std::pair(file.stamp, file.file); });
  const auto twice = std::ranges::adjacent_find(found.files, {}, &StampedFile::stamp);
  if (twice != found.files.end())
    throw FileError(std::next(twice)->file,
                    fmt::format("has the same number as {}; remove one of them", twice->file.filename().string()));
  return found;
}

StampedFiles depthsOf(const std::filesystem::path& folder, const RgbdLayout& layout) {
  const bool isListed = hasList(folder, layout);
  StampedFiles depths =
      isListed ? listedFiles(folder, layout.list) : numberedFiles(folder, layout.depth, kPictureEndings);
  if (!depths.files.empty()) return depths;
  if (isListed) throw FileError(folder / layout.list, "lists no pictures");
  throw FileError(folder / layout.depth.folder, "has no pictures");
}

StampedFiles colorsOf(const std::filesystem::path& folder, const RgbdLayout& layout) {
  if (hasList(folder, layout))
    return isFile(folder / layout.colorList) ? listedFiles(folder, layout.colorList) : StampedFiles{};
  for (const NumberedFiles& files : layout.colors) {
    const bool isUsed = !files.folder.empty() || !files.end.empty();
    if (!isUsed || !isFolder(folder / files.folder)) continue;
    StampedFiles colors = numberedFiles(folder, files, kPictureEndings);
    if (!colors.files.empty()) return colors;
  }
  return {};
}

}  // namespace palpate
