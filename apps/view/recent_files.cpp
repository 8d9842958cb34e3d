#include "apps/view/recent_files.hpp"

#include <algorithm>
#include <fstream>

#include "apps/cli/system_places.hpp"
#include "engine/core/atomic_file.hpp"

namespace palpate {

namespace {

std::filesystem::path storePath() {
  const std::filesystem::path folder = stateFolder();
  return folder.empty() ? folder : folder / "palpate" / "recent";
}

}  // namespace

RecentFiles::RecentFiles() : store_(storePath()) {
  std::ifstream in(store_);
  for (std::string line; files_.size() < kMost && std::getline(in, line);)
    if (!line.empty()) files_.push_back(line);
}

void RecentFiles::add(const std::string& file) {
  std::error_code ignored;
  const std::string whole = std::filesystem::absolute(file, ignored).string();
  std::erase(files_, whole);
  files_.insert(files_.begin(), whole);
  if (files_.size() > kMost) files_.resize(kMost);
  if (store_.empty()) return;
  try {
    std::filesystem::create_directories(store_.parent_path());
    AtomicFile out(store_);
    for (const std::string& each : files_) out.write(each + "\n");
    out.commit();
  } catch (const std::exception&) {  // a list of files is no reason to stop anybody
  }
}

}  // namespace palpate
