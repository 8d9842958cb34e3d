// How much memory a cloud needs, known before it is read.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace palpate {

struct CloudFormat;

/// What reading a file needs, estimated from what it declares.
struct MemoryNeed {
  std::filesystem::path file;
  std::uint64_t needed_bytes = 0, free_bytes = 0;

  /// "needs about 120 GB of memory, and 18 GB are free".
  std::string sentence() const;
};

/// Limits what is read to the memory that is free.
struct MemoryLimit {
  /// Called before a cloud is read that needs more; it is read unless this throws. Empty: no limit.
  std::function<void(const MemoryNeed&)> exceeded;
  std::uint64_t furtherPerPoint_bytes = 0;  ///< that the caller needs besides the cloud itself
};

/// Nothing if the cloud of that file needs less than is free. Small files are not opened. Throws FileError.
std::optional<MemoryNeed> exceedingNeed(const std::filesystem::path& file, const CloudFormat& format,
                                        std::uint64_t furtherPerPoint_bytes);

}  // namespace palpate
