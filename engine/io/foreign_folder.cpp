#include "engine/io/foreign_folder.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <string>
#include <vector>

#include "engine/core/error.hpp"
#include "engine/io/rgbd_folder.hpp"

namespace palpate {

namespace {

constexpr int kDeepest = 2;               // folders below the one that was named: sparse/0
constexpr std::size_t kMaxEntries = 500;  // that are looked at
constexpr std::size_t kMaxNamed = 3;

bool isFolderOfFormat(const std::filesystem::path& path, const CloudFormats& formats) {
  return isRgbdFolder(path) || std::ranges::any_of(formats.all(), [&](const CloudFormat& format) {
           return !format.folder.empty() && format.holds && format.holds(path);
         });
}

/// Whether a name ends as a format's files do; the content of the files is not checked.
bool hasKnownEnding(const std::filesystem::path& file, const CloudFormats& formats) {
  const std::string ending = file.extension().string();
  return !ending.empty() && std::ranges::any_of(formats.all(), [&](const CloudFormat& format) {
    return format.read && std::ranges::find(format.endings, ending) != format.endings.end();
  });
}

/// Files and folders in it that can be read, folders first.
std::vector<std::string> readableIn(const std::filesystem::path& folder, const CloudFormats& formats) {
  std::vector<std::string> folders, files;
  std::error_code ended;
  std::size_t seen = 0;
  for (std::filesystem::recursive_directory_iterator at(
           folder, std::filesystem::directory_options::skip_permission_denied, ended);
       !ended && at != std::filesystem::recursive_directory_iterator() && seen < kMaxEntries; at.increment(ended)) {
    ++seen;
    std::error_code ignored;
    if (at->is_directory(ignored)) {
      if (isFolderOfFormat(at->path(), formats)) folders.push_back(at->path().string());
      if (at.depth() + 1 >= kDeepest) at.disable_recursion_pending();
    } else if (at.depth() == 0 && hasKnownEnding(at->path(), formats)) {
      files.push_back(at->path().string());
    }
  }
  std::ranges::sort(folders);
  std::ranges::sort(files);
  folders.insert(folders.end(), files.begin(), files.end());
  if (folders.size() > kMaxNamed) folders.resize(kMaxNamed);
  return folders;
}

}  // namespace

void refuseFolder(const std::filesystem::path& folder, const CloudFormats& formats) {
  std::error_code ignored;
  if (std::filesystem::exists(folder / "metadata.yaml", ignored))
    throw FileError(folder,
                    "is a folder with a bag of ROS 2, which is not read; play it, and name ros:TOPIC as the model");
  const std::vector<std::string> within = readableIn(folder, formats);
  throw FileError(folder, fmt::format("is not a folder of COLMAP, {}; {}", rgbdLayoutsRead(false),
                                      within.empty() ? "name a file in it"
                                                     : fmt::format("name one of {}", fmt::join(within, ", "))));
}

}  // namespace palpate
