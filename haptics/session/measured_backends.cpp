#include "haptics/session/measured_backends.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <fstream>
#include <vector>

#include "engine/core/atomic_file.hpp"
#include "engine/core/error.hpp"
#include "haptics/session/cache_folder.hpp"

namespace palpate {

namespace {

constexpr std::string_view kFirstLine = "palpate back ends, version 1: p99 of a tick on the GPU and on the CPU, us; of";

struct Entry {
  BackendPair times;
  std::string key;
};

// Reads a number and the space behind it.
bool take(std::string_view& line, double& value) {
  const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), value);
  if (error != std::errc() || !std::isfinite(value) || value <= 0 || end == line.data() + line.size() || *end != ' ')
    return false;
  line.remove_prefix(static_cast<std::size_t>(end - line.data()) + 1);
  return true;
}

// Throws FileError for a damaged file; one that does not exist is empty.
std::vector<Entry> entriesOf(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string line;
  if (!in || !std::getline(in, line)) return {};
  if (line != kFirstLine) throw FileError(file, "is not a file of measured back ends of this palpate");
  std::vector<Entry> entries;
  for (std::size_t number = 2; std::getline(in, line); ++number) {
    Entry entry;
    std::string_view rest = line;
    if (entries.size() == MeasuredBackends::kMax || !take(rest, entry.times.gpu_us) ||
        !take(rest, entry.times.cpu_us) || rest.empty())
      throw FileError(file, fmt::format("is damaged in line {}", number));
    entry.key = rest;
    entries.push_back(std::move(entry));
  }
  return entries;
}

std::vector<Entry> entriesOrNone(const std::filesystem::path& file) {
  try {
    return entriesOf(file);
  } catch (const FileError&) {
    return {};
  }
}

}  // namespace

std::filesystem::path MeasuredBackends::usualFile() {
  const std::filesystem::path folder = cacheFolder();
  return folder.empty() ? folder : folder / "palpate" / "backends";
}

std::optional<BackendPair> MeasuredBackends::recall(std::string_view key,
                                                    const std::function<void(std::string_view)>& damaged) const {
  try {
    for (const Entry& entry : entriesOf(file_))
      if (entry.key == key) return entry.times;
  } catch (const FileError& error) {
    damaged(fmt::format("{}; the back ends are measured again", error.what()));
  }
  return std::nullopt;
}

void MeasuredBackends::remember(std::string_view key, const BackendPair& times) const {
  if (file_.empty()) return;
  std::vector<Entry> entries = entriesOrNone(file_);
  std::erase_if(entries, [&](const Entry& entry) { return entry.key == key; });
  entries.insert(entries.begin(), {times, std::string(key)});
  if (entries.size() > kMax) entries.resize(kMax);
  try {
    std::filesystem::create_directories(file_.parent_path());
    AtomicFile out(file_);
    out.write(fmt::format("{}\n", kFirstLine));
    for (const Entry& entry : entries)
      out.write(fmt::format("{:.1f} {:.1f} {}\n", entry.times.gpu_us, entry.times.cpu_us, entry.key));
    out.commit();
  } catch (const std::exception&) {  // the next start measures again
  }
}

std::size_t MeasuredBackends::count() const { return entriesOrNone(file_).size(); }

bool MeasuredBackends::forget() const {
  std::error_code failed;
  const bool existed = std::filesystem::remove(file_, failed);
  if (failed) throw FileError(file_, "cannot be removed: " + failed.message());
  return existed;
}

}  // namespace palpate
