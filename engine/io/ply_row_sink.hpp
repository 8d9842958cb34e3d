// Who takes the rows of a PLY file's points, whatever becomes of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace palpate {

/// Takes packed rows: scalars in the order of the header, lists left out.
class PlyRowSink {
 public:
  virtual ~PlyRowSink() = default;

  virtual std::size_t rowBytes() const = 0;
  /// For a number of rows that may be in the file, as far as its size tells.
  virtual void reserve(std::uint64_t promised) = 0;

  /// How many bytes of rows it takes best at a time: as many as a processor has at hand, or enough for many threads.
  virtual std::size_t bytesAtOnce() const { return std::size_t{1} << 20; }

  struct BadRow {
    std::size_t row;  ///< within the rows given
    std::string what;
  };
  /// Appends `count` rows; names the first that cannot be right.
  virtual std::optional<BadRow> append(const std::byte* rows, std::size_t count, bool swapBytes) = 0;
};

}  // namespace palpate
