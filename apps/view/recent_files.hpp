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
  static constexpr std::size_t kMax = 10;

  RecentFiles();
  const std::vector<std::string>& files() const { return files_; }
  /// Those that were not there when the program began; kept, as a drive may come back.
  const std::vector<std::string>& gone() const { return gone_; }
  /// A file, a folder or a scene that is built in; nothing else can be found again by its name.
  void add(const std::string& model);
  /// It cannot be read.
  void forget(const std::string& model);

 private:
  std::filesystem::path store_;  // empty: nowhere
  void store() const;
  std::vector<std::string> files_, gone_;
};

}  // namespace palpate
