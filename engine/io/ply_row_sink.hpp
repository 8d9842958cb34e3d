// Interface of receivers of the rows of a PLY file's points.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace palpate {

/// Receives packed rows: scalars in the order of the header, without lists.
class PlyRowSink {
 public:
  virtual ~PlyRowSink() = default;

  virtual std::size_t rowBytes() const = 0;
  /// Reserves memory for a number of rows that is plausible for the size of the file.
  virtual void reserve(std::uint64_t promised) = 0;

  /// Preferred number of bytes per call: as many as fit into the cache, or enough for many threads.
  virtual std::size_t bytesAtOnce() const { return std::size_t{1} << 20; }

  struct BadRow {
    std::size_t row;  ///< index within the given rows
    std::string what;
  };
  /// Appends `count` rows; returns the first invalid one.
  virtual std::optional<BadRow> append(const std::byte* rows, std::size_t count, bool swapBytes) = 0;
};

}  // namespace palpate
