// Times of back ends that earlier programs have measured, in a file of the user's cache folder.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace palpate {

/// 99th percentiles of a tick, us.
struct BackendPair {
  double gpu_us = 0, cpu_us = 0;
};

/// A line of text for each measurement, the newest first. What cannot be read or written is measured again and costs
/// nothing else. Several programs may share the file: the last one to write wins.
class MeasuredBackends {
 public:
  /// Maximum number of measurements; beyond it the oldest are dropped.
  static constexpr std::size_t kMax = 64;

  /// An empty path remembers nothing.
  explicit MeasuredBackends(std::filesystem::path file = usualFile()) : file_(std::move(file)) {}
  /// palpate/backends in the user's cache folder; empty if that is unknown.
  static std::filesystem::path usualFile();

  const std::filesystem::path& file() const { return file_; }
  /// The measurement of that key, a line of text. `damaged` receives a sentence if the file cannot be read, which then
  /// counts as empty.
  std::optional<BackendPair> recall(std::string_view key, const std::function<void(std::string_view)>& damaged) const;
  /// Replaces the measurement of that key. Fails silently.
  void remember(std::string_view key, const BackendPair& times) const;
  /// Number of measurements; 0 if there is no file, or if it is damaged.
  std::size_t count() const;
  /// Removes the file. Returns whether there was one. Throws FileError.
  bool forget() const;

 private:
  std::filesystem::path file_;
};

}  // namespace palpate
