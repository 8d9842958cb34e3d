// Contents of the file dialogue: a folder, and its files that pass a filter.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace palpate {

class FileBrowser {
 public:
  /// Passes files with one of these endings, case-insensitive; without endings all files.
  struct Filter {
    std::string name;
    std::vector<std::string> endings;

    bool lets(const std::filesystem::path& file) const;
  };
  struct Entry {
    std::string name;
    bool isFolder = false;
    std::uintmax_t bytes = 0;
  };

  /// The first filter is active. `folder`: the first folder; the working folder where it does not exist.
  FileBrowser(const std::filesystem::path& folder, std::vector<Filter> filters);

  const std::filesystem::path& folder() const { return folder_; }
  /// Folders first, then files, each sorted by name; without names that begin with a dot.
  std::span<const Entry> entries() const { return entries_; }
  /// Why the folder cannot be read; empty if it was read.
  const std::string& failure() const { return failure_; }
  /// Whether the folder itself can be opened as a model: a recorded camera, a reconstruction.
  bool isModel() const { return isModel_; }
  std::span<const Filter> filters() const { return filters_; }
  std::size_t filter() const { return filter_; }

  /// Goes to a folder, relative to this one or by an absolute path. If it does not exist, stays and sets failure().
  void go(const std::filesystem::path& folder);
  void goUp() { go(folder_.parent_path()); }
  void choose(std::size_t filter);
  /// Path of a name in this folder.
  std::filesystem::path placeOf(const std::string& name) const { return folder_ / name; }

 private:
  void look();

  std::filesystem::path folder_;
  std::vector<Filter> filters_;
  std::size_t filter_ = 0;
  std::vector<Entry> entries_;
  std::string failure_;
  bool isModel_ = false;
};

/// One filter for all readable formats, one for each format, and one for all files. Formats that are folders have no
/// filter: the folder itself is opened.
std::vector<FileBrowser::Filter> filtersToOpen();
/// One filter for each format of points that can be written; with `triangles`, for PLY and each format of triangles.
std::vector<FileBrowser::Filter> filtersToSave(bool triangles);

}  // namespace palpate
