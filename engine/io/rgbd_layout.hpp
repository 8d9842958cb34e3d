// Layouts of recorded depth cameras: where a folder has its pictures, and what their names mean.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/depth_stream.hpp"

namespace palpate {

/// Files of a folder whose names, without the ending, begin and end like this around a number.
struct NumberedFiles {
  std::string_view folder, begin, end;
};

struct RgbdLayout {
  std::string_view name, sign;                 ///< `sign`: its files, for messages
  std::string_view list = {}, colorList = {};  ///< files with the times and names of pictures; they may be missing
  std::string_view beside = {};                ///< another file or folder that it must have
  bool namesHaveDecimals = false;              ///< whether pictures without a list must be named by seconds
  NumberedFiles depth = {};
  std::array<NumberedFiles, 3> colors = {};  ///< the first folder with pictures counts
  double depthScale = 0;                     ///< values per metre, unless the intrinsics say so
  DepthCamera usualCamera = {};              ///< without intrinsics
};

/// The layout of a folder; null: none.
const RgbdLayout* rgbdLayoutOf(const std::filesystem::path& folder);
/// All layouts, for messages: "TUM, ScanNet, …", or "TUM (depth.txt), …".
std::string rgbdLayoutsRead(bool withSigns);

/// A file at a time (seconds) or with a number.
struct StampedFile {
  double stamp = 0;
  std::filesystem::path file;
  std::uint64_t line = 0;  ///< of the list; 0: without a list
};
/// Sorted by stamp.
struct StampedFiles {
  std::vector<StampedFile> files;
  bool areTimes = false;
};

inline constexpr std::uint64_t kMaxFrameNumber = 100'000'000;  ///< months at 30 Hz

/// The files whose endings are among `endings` (in lower case). Throws FileError for names without a number, and for
/// duplicate ones. Numbers with decimals are seconds, whole ones since 2001 seconds, ms, µs or ns by their size.
StampedFiles numberedFiles(const std::filesystem::path& folder, const NumberedFiles& files,
                           std::span<const std::string_view> endings);
/// The pictures of a layout; of colours those of the first folder that has some. Throws FileError as above, and with
/// the line for an invalid list.
StampedFiles depthsOf(const std::filesystem::path& folder, const RgbdLayout& layout);
StampedFiles colorsOf(const std::filesystem::path& folder, const RgbdLayout& layout);

}  // namespace palpate
