#include "apps/view/recent_files.hpp"

#include <algorithm>
#include <fstream>

#include "apps/cli/system_places.hpp"
#include "engine/core/atomic_file.hpp"
#include "haptics/session/simulation.hpp"

namespace palpate {

std::filesystem::path stateFile(const char* name) {
  const std::filesystem::path folder = stateFolder();
  return folder.empty() ? folder : folder / "palpate" / name;
}

std::string lastingName(const std::string& model) {
  std::error_code ignored;
  if (std::filesystem::exists(model, ignored)) return std::filesystem::absolute(model, ignored).string();
  return isBuiltInScene(model) ? model : std::string();
}

RecentFiles::RecentFiles() : store_(stateFile("recent")) {
  std::ifstream in(store_);
  for (std::string line; files_.size() + gone_.size() < kMax && std::getline(in, line);)
    if (!line.empty()) (lastingName(line).empty() ? gone_ : files_).push_back(line);
}

void RecentFiles::add(const std::string& model) {
  const std::string name = lastingName(model);
  if (name.empty()) return;
  std::erase(files_, name);
  std::erase(gone_, name);
  files_.insert(files_.begin(), name);
  if (files_.size() > kMax) files_.resize(kMax);
  gone_.resize(std::min(gone_.size(), kMax - files_.size()));
  store();
}

void RecentFiles::forget(const std::string& model) {
  if (std::erase(files_, model) + std::erase(files_, lastingName(model)) > 0) store();
}

void RecentFiles::store() const {
  if (store_.empty()) return;
  try {
    std::filesystem::create_directories(store_.parent_path());
    AtomicFile out(store_);
    for (const auto* const list : {&files_, &gone_})
      for (const std::string& each : *list) out.write(each + "\n");
    out.commit();
  } catch (const std::exception&) {  // not important enough for an error
  }
}

}  // namespace palpate
