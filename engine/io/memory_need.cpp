#include "engine/io/memory_need.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "engine/core/free_memory.hpp"
#include "engine/io/cloud_format.hpp"

namespace palpate {

namespace {

constexpr std::uint64_t kMaxPerByte = 100;    // bytes of memory for one of a file: compressed points, 2 bytes each
constexpr std::uint64_t kPoint_bytes = 28;    // position, normal, colour
constexpr std::uint64_t kProperty_bytes = 8;  // of an attribute, as a double
constexpr std::size_t kPositionProperties = 3;

std::string sizeOf(std::uint64_t bytes) {
  constexpr double kGB = 1e9, kMB = 1e6;
  const auto size = static_cast<double>(bytes);
  return size < kGB ? fmt::format("{:.0f} MB", size / kMB) : fmt::format("{:.3g} GB", size / kGB);
}

struct Rows {
  std::uint64_t count = 0;
  std::size_t properties = kPositionProperties;
};

// Text is not read for this: its lines are taken to be as long as the first ones.
Rows rowsOfText(const FileStart& start) {
  const auto lines = std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::ranges::count(start.bytes, '\n')));
  constexpr std::size_t kLooked = 16;
  std::size_t longest = kPositionProperties;
  for (const auto& words : start.lines(kLooked)) longest = std::max(longest, words.size());
  return {.count = start.size / std::max<std::uint64_t>(1, start.bytes.size() / lines), .properties = longest};
}

Rows rowsOf(const std::filesystem::path& file, const CloudFormat& format) {
  const auto start = startOf(file);
  if (start && start->isText() && (format.isText || format.ofTriangles)) return rowsOfText(*start);
  for (const FileElement& element : format.contents(file).elements)
    if (element.name == "vertex" || element.name == "Gaussian")
      return {.count = element.count, .properties = std::max(kPositionProperties, element.properties.size())};
  return {};
}

std::uint64_t bytesOf(const std::filesystem::path& path) {
  std::error_code unknown;
  if (!std::filesystem::is_directory(path, unknown)) {
    const auto size = std::filesystem::file_size(path, unknown);
    return unknown ? 0 : size;
  }
  std::uint64_t bytes = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(path, unknown))
    if (entry.is_regular_file(unknown)) bytes += entry.file_size(unknown);
  return bytes;
}

}  // namespace

std::string MemoryNeed::sentence() const {
  return fmt::format("needs about {} of memory, and {} are free", sizeOf(needed_bytes), sizeOf(free_bytes));
}

std::optional<MemoryNeed> exceedingNeed(const std::filesystem::path& file, const CloudFormat& format,
                                        std::uint64_t furtherPerPoint_bytes) {
  const std::uint64_t free_bytes = freeMemory_bytes();
  if (bytesOf(file) < free_bytes / kMaxPerByte) return std::nullopt;
  const Rows rows = rowsOf(file, format);
  const std::uint64_t perPoint_bytes =
      kPoint_bytes + furtherPerPoint_bytes + kProperty_bytes * (rows.properties - kPositionProperties);
  if (rows.count < free_bytes / perPoint_bytes) return std::nullopt;
  return MemoryNeed{.file = file, .needed_bytes = rows.count * perPoint_bytes, .free_bytes = free_bytes};
}

}  // namespace palpate
