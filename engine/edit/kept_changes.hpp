#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace palpate {

/// The oldest changes of a history, on the disk, within a budget; the oldest of them are dropped first. They are in
/// files that no other program sees and that end with this program. Nothing is an error: what cannot be written or read
/// is lost, and the caller counts it. For one thread.
class KeptChanges {
 public:
  /// Its files are made in `folder`, and the folder with the first one.
  KeptChanges(std::filesystem::path folder, std::uint64_t budget_bytes)
      : folder_(std::move(folder)), budget_(budget_bytes) {}

  /// Adds the next change. Returns the number of changes that are lost for it: the oldest ones for which there is no
  /// room, or, if it cannot be written, all of them and itself.
  std::size_t push(std::span<const std::byte> bytes);
  /// Removes the change added last and returns it. Nothing: it cannot be read, or has other bytes than were written.
  std::optional<std::vector<std::byte>> pop();
  /// Removes all; returns their number.
  std::size_t clear();
  std::size_t count() const;

 private:
  struct Change {
    std::uint64_t at, bytes, checksum;
  };
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  // The oldest changes can be dropped file by file.
  struct Segment {
    std::unique_ptr<std::FILE, Close> file;
    std::vector<Change> changes;
    std::uint64_t end = 0;
  };
  bool append(std::span<const std::byte> bytes);

  std::filesystem::path folder_;
  std::uint64_t budget_;
  std::deque<Segment> segments_;  // none is empty
};

}  // namespace palpate
