// A scripted path of the stylus: key points in time, straight lines between them.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "engine/core/vec.hpp"

namespace palpate {

struct PathKey {
  double t_s = 0;
  DVec3 position{0};  ///< model units, in the coordinates of the model's file
};

/// At least one key; times increase strictly.
class Path {
 public:
  explicit Path(std::vector<PathKey> keys);

  std::span<const PathKey> keys() const& { return keys_; }
  void keys() const&& = delete;  // the keys are destroyed with the path

  /// The time of the last key. Sessions begin at 0, whatever the first key's time.
  double duration_s() const { return keys_.back().t_s; }

  /// Linear between keys, at rest before the first and after the last. O(log keys).
  DVec3 at(double t_s) const noexcept;

 private:
  std::vector<PathKey> keys_;
};

/// Reads comma-separated columns `t_s,x,y,z` under that header: seconds, not negative and increasing, and model units.
/// Empty lines and lines that begin with # are skipped. Throws FileError with the line.
Path readPathCsv(const std::filesystem::path& file);

}  // namespace palpate
