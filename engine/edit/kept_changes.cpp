#include "engine/edit/kept_changes.hpp"

#include <system_error>

#include "engine/core/checksum.hpp"
#include "engine/core/system_file.hpp"

namespace palpate {

namespace {

constexpr std::uint64_t kSegments = 8;  // of the whole budget

std::uint64_t checksumOf(std::span<const std::byte> bytes) {
  Checksum sum;
  sum.add(bytes);
  return sum.value();
}

}  // namespace

std::size_t KeptChanges::push(std::span<const std::byte> bytes) {
  if (bytes.size() > budget_ || !append(bytes)) return clear() + 1;
  std::uint64_t total = 0;
  for (const Segment& segment : segments_) total += segment.end;
  std::size_t lost = 0;
  for (; total > budget_; segments_.pop_front()) {
    total -= segments_.front().end;
    lost += segments_.front().changes.size();
  }
  return lost;
}

bool KeptChanges::append(std::span<const std::byte> bytes) {
  if (segments_.empty() || segments_.back().end + bytes.size() > budget_ / kSegments) {
    std::error_code ignored;
    std::filesystem::create_directories(folder_, ignored);
    std::FILE* const file = openScratch(folder_);
    if (!file) return false;
    std::setvbuf(file, nullptr, _IONBF, 0);  // so that a full disk is noticed here
    segments_.push_back({std::unique_ptr<std::FILE, Close>(file), {}, 0});
  }
  Segment& segment = segments_.back();
  std::FILE* const file = segment.file.get();
  if (!seekTo(file, segment.end) || std::fwrite(bytes.data(), 1, bytes.size(), file) != bytes.size()) {
    if (segment.changes.empty()) segments_.pop_back();
    return false;
  }
  segment.changes.push_back({segment.end, bytes.size(), checksumOf(bytes)});
  segment.end += bytes.size();
  return true;
}

std::optional<std::vector<std::byte>> KeptChanges::pop() {
  if (segments_.empty()) return std::nullopt;
  Segment& segment = segments_.back();
  const Change change = segment.changes.back();
  std::vector<std::byte> bytes(change.bytes);
  const bool isRead =
      readAt(segment.file.get(), change.at, bytes) == bytes.size() && checksumOf(bytes) == change.checksum;
  segment.changes.pop_back();
  segment.end = change.at;
  if (segment.changes.empty()) segments_.pop_back();
  if (!isRead) return std::nullopt;
  return bytes;
}

std::size_t KeptChanges::clear() {
  const std::size_t lost = count();
  segments_.clear();
  return lost;
}

std::size_t KeptChanges::count() const {
  std::size_t count = 0;
  for (const Segment& segment : segments_) count += segment.changes.size();
  return count;
}

}  // namespace palpate
