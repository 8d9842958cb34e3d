// What programs have found out about this machine, in a file of the user's cache folder.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// A line of text for each value, which precedes its key, the newest first. What cannot be read or written is found out
/// again and costs nothing else. Several programs may share the file: the last one to write wins.
class RememberedLines {
 public:
  /// Maximum number of values; beyond it the oldest are dropped.
  static constexpr std::size_t kMax = 64;
  /// Length of the value at the start of a line; 0 if there is none.
  using ValueLength = std::size_t (*)(std::string_view line);
  struct Kind {
    std::string_view firstLine;  ///< of the file
    std::string_view what;       ///< for messages
    ValueLength valueLength;
  };

  /// An empty path remembers nothing.
  RememberedLines(std::filesystem::path file, const Kind& kind) : file_(std::move(file)), kind_(kind) {}
  /// palpate/`name` in the user's cache folder; empty if that is unknown.
  static std::filesystem::path usualFile(std::string_view name);

  const std::filesystem::path& file() const { return file_; }
  /// The value of that key, a line of text. `damaged` receives a message if the file cannot be read, which then counts
  /// as empty.
  std::optional<std::string> recall(std::string_view key, const std::function<void(std::string_view)>& damaged) const;
  /// Replaces the value of that key. Fails silently.
  void remember(std::string_view key, std::string_view value) const;
  /// Number of values; 0 if there is no file, or if it is damaged.
  std::size_t count() const { return entriesOrNone().size(); }
  /// Removes the file. Returns whether there was one. Throws FileError.
  bool forget() const;

 private:
  struct Entry {
    std::string value, key;
  };
  std::vector<Entry> entries() const;
  std::vector<Entry> entriesOrNone() const;

  std::filesystem::path file_;
  Kind kind_;
};

}  // namespace palpate
