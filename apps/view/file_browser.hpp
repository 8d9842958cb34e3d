// What a person looks through for a file: a folder, and what of it a filter lets through.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace palpate {

class FileBrowser {
 public:
  /// Of the files those that end so, in any case; without endings all of them.
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

  /// The first filter is in force. `folder`: where it begins; the working folder where there is no such one.
  FileBrowser(const std::filesystem::path& folder, std::vector<Filter> filters);

  const std::filesystem::path& folder() const { return folder_; }
  /// Folders first, each kind by its name; what begins with a dot is left out.
  std::span<const Entry> entries() const { return entries_; }
  /// Why the folder cannot be read; empty: it was.
  const std::string& failure() const { return failure_; }
  /// Whether the folder itself is what can be opened: a recorded camera, a reconstruction.
  bool isModel() const { return isModel_; }
  std::span<const Filter> filters() const { return filters_; }
  std::size_t filter() const { return filter_; }

  /// Into a folder of this one, or to a path from anywhere. Stays where it is, and says why, where there is none.
  void go(const std::filesystem::path& folder);
  void goUp() { go(folder_.parent_path()); }
  void choose(std::size_t filter);
  /// What a name in this folder is called from anywhere.
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

/// One for all formats that are read together, one for each, and one for all files. Formats of folders are opened as
/// what they are: the folder's own name.
std::vector<FileBrowser::Filter> filtersToOpen();
/// One for each format that points are written in; of triangles the others.
std::vector<FileBrowser::Filter> filtersToSave(bool triangles);

}  // namespace palpate
