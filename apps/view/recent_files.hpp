#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace palpate {

/// The models that were opened last, the latest first: kept in $XDG_STATE_HOME/palpate/recent (or ~/.local/state; on
/// Windows %LOCALAPPDATA%).
/// Where that cannot be read or written they last as long as the program.
class RecentFiles {
 public:
  static constexpr std::size_t kMost = 10;

  RecentFiles();
  const std::vector<std::string>& files() const { return files_; }
  void add(const std::string& file);

 private:
  std::filesystem::path store_;  // empty: nowhere
  std::vector<std::string> files_;
};

}  // namespace palpate
