#include "haptics/session/remembered_lines.hpp"

#include <fmt/format.h>

#include <fstream>

#include "engine/core/atomic_file.hpp"
#include "engine/core/error.hpp"
#include "haptics/session/cache_folder.hpp"

namespace palpate {

std::filesystem::path RememberedLines::usualFile(std::string_view name) {
  const std::filesystem::path folder = cacheFolder();
  return folder.empty() ? folder : folder / "palpate" / name;
}

// Throws FileError for a damaged file; one that does not exist is empty.
std::vector<RememberedLines::Entry> RememberedLines::entries() const {
  std::ifstream in(file_);
  std::string line;
  if (!in || !std::getline(in, line)) return {};
  if (line != kind_.firstLine) throw FileError(file_, fmt::format("is not a file of {} of this palpate", kind_.what));
  std::vector<Entry> entries;
  for (std::size_t number = 2; std::getline(in, line); ++number) {
    const std::size_t length = kind_.valueLength(line);
    if (entries.size() == kMax || length == 0 || length + 1 >= line.size() || line[length] != ' ')
      throw FileError(file_, fmt::format("is damaged in line {}", number));
    entries.push_back({.value = line.substr(0, length), .key = line.substr(length + 1)});
  }
  return entries;
}

std::vector<RememberedLines::Entry> RememberedLines::entriesOrNone() const {
  try {
    return entries();
  } catch (const FileError&) {
    return {};
  }
}

std::optional<std::string> RememberedLines::recall(std::string_view key,
                                                   const std::function<void(std::string_view)>& damaged) const {
  try {
    for (Entry& entry : entries())
      if (entry.key == key) return std::move(entry.value);
  } catch (const FileError& error) {
    damaged(fmt::format("{}; its {} are found out again", error.what(), kind_.what));
  }
  return std::nullopt;
}

void RememberedLines::remember(std::string_view key, std::string_view value) const {
  if (file_.empty()) return;
  std::vector<Entry> all = entriesOrNone();
  std::erase_if(all, [&](const Entry& entry) { return entry.key == key; });
  all.insert(all.begin(), {std::string(value), std::string(key)});
  if (all.size() > kMax) all.resize(kMax);
  try {
    std::filesystem::create_directories(file_.parent_path());
    AtomicFile out(file_);
    out.write(fmt::format("{}\n", kind_.firstLine));
    for (const Entry& entry : all) out.write(fmt::format("{} {}\n", entry.value, entry.key));
    out.commit();
  } catch (const std::exception&) {  // the next program finds it out again
  }
}

bool RememberedLines::forget() const {
  std::error_code failed;
  const bool existed = std::filesystem::remove(file_, failed);
  if (failed) throw FileError(file_, "cannot be removed: " + failed.message());
  return existed;
}

}  // namespace palpate
