#include "apps/view/file_browser.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "engine/io/cloud_formats.hpp"
#include "engine/io/rgbd_folder.hpp"

namespace palpate {

namespace {

std::string lowered(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

FileBrowser::Filter filterOf(const CloudFormat& format) {
  FileBrowser::Filter filter;
  for (const std::string_view ending : format.endings) filter.endings.emplace_back(ending);
  filter.name = fmt::format("{} ({})", format.name, fmt::join(filter.endings, ", "));
  return filter;
}

}  // namespace

bool FileBrowser::Filter::lets(const std::filesystem::path& file) const {
  const std::string lower = lowered(file.filename().string());
  return endings.empty() ||
         std::ranges::any_of(endings, [&](const std::string& ending) { return lower.ends_with(ending); });
}

FileBrowser::FileBrowser(const std::filesystem::path& folder, std::vector<Filter> filters)
    : filters_(std::move(filters)) {
  std::error_code failed;
  folder_ = std::filesystem::current_path(failed);
  go(folder.empty() ? folder_ : folder);
  if (!failure_.empty()) look();
}

void FileBrowser::go(const std::filesystem::path& folder) {
  std::error_code failed;
  const std::filesystem::path there = std::filesystem::weakly_canonical(folder_ / folder, failed);
  if (failed || !std::filesystem::is_directory(there, failed)) {
    failure_ = fmt::format("{} is not a folder", (folder_ / folder).string());
    return;
  }
  folder_ = there;
  look();
}

void FileBrowser::choose(std::size_t filter) {
  filter_ = std::min(filter, filters_.size() - 1);
  look();
}

void FileBrowser::look() {
  failure_.clear();
  entries_.clear();
  isModel_ =
      isRgbdFolder(folder_.string()) || std::ranges::any_of(cloudFormats().all(), [&](const CloudFormat& format) {
        return !format.folder.empty() && format.holds != nullptr && format.holds(folder_);
      });
  std::error_code failed;
  std::filesystem::directory_iterator each(folder_, failed);
  for (; !failed && each != std::filesystem::directory_iterator(); each.increment(failed)) {
    std::error_code ignored;
    Entry entry{.name = each->path().filename().string(), .isFolder = each->is_directory(ignored)};
    if (entry.name.starts_with('.')) continue;
    if (!entry.isFolder && (!each->is_regular_file(ignored) || !filters_[filter_].lets(each->path()))) continue;
    if (!entry.isFolder) entry.bytes = each->file_size(ignored);
    entries_.push_back(std::move(entry));
  }
  if (failed) failure_ = fmt::format("{} cannot be read: {}", folder_.string(), failed.message());
  std::ranges::sort(entries_, [](const Entry& a, const Entry& b) {
    return a.isFolder != b.isFolder ? a.isFolder : lowered(a.name) < lowered(b.name);
  });
}

std::vector<FileBrowser::Filter> filtersToOpen() {
  std::vector<FileBrowser::Filter> filters{{.name = "all readable formats", .endings = {".json"}}};
  for (const CloudFormat& format : cloudFormats().all()) {
    if (format.read == nullptr || format.endings.empty()) continue;
    FileBrowser::Filter filter = filterOf(format);
    for (const std::string& ending : filter.endings)
      if (std::ranges::find(filters.front().endings, ending) == filters.front().endings.end())
        filters.front().endings.push_back(ending);
    filters.push_back(std::move(filter));
  }
  filters.push_back({.name = "simulation scenes (.json)", .endings = {".json"}});
  filters.push_back({.name = "all files", .endings = {}});
  return filters;
}

std::vector<FileBrowser::Filter> filtersToSave(bool triangles) {
  std::vector<FileBrowser::Filter> filters;
  for (const CloudFormat& format : cloudFormats().all())
    if (format.write != nullptr && !format.onlyCopied &&
        (triangles ? format.ofTriangles || format.keepsTriangles : !format.ofTriangles))
      filters.push_back(filterOf(format));
  return filters;
}

}  // namespace palpate
