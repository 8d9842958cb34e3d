#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace palpate {

/// Absolute path, or the name of a built-in scene. Empty: the model cannot be found again.
std::string lastingName(const std::string& model);
/// A file of this name for what the window remembers; empty: it has no folder for that.
std::filesystem::path stateFile(const char* name);

/// The models that were opened last, the latest first: kept in $XDG_STATE_HOME/palpate/recent (or ~/.local/state; on
/// Windows %LOCALAPPDATA%).
/// If that file cannot be read or written, the list lasts as long as the program.
class RecentFiles {
 public:
  static constexpr std::size_t kMax = 10;

  RecentFiles();
  const std::vector<std::string>& files() const { return files_; }
  /// Models that did not exist at the program's start; they stay in the list, as a drive may be mounted again.
  const std::vector<std::string>& gone() const { return gone_; }
  /// Adds a file, a folder or a built-in scene; other models cannot be found again by name and are ignored.
  void add(const std::string& model);
  /// Removes a model that cannot be read.
  void forget(const std::string& model);

 private:
  std::filesystem::path store_;  // empty: the list is not stored
  void store() const;
  std::vector<std::string> files_, gone_;
};

}  // namespace palpate
