// Reading LAS: points by columns, many at a time, on all cores.
#pragma once

#include <atomic>
#include <memory>

#include "engine/core/bare_vector.hpp"
#include "engine/core/log.hpp"
#include "engine/io/chunked_file.hpp"
#include "engine/io/las_layout.hpp"

namespace palpate {

/// A file up to its first point.
struct LasHead {
  LasHeader header;
  LasPointFormat format;
  std::vector<std::byte> bytes;
  std::vector<std::byte> descriptors;  ///< of extra bytes
  std::vector<LasExtraField> extra;
  std::vector<std::string> comments;  ///< as in StoredAs
};

/// Reads front to back. Throws FileError with the byte that is wrong.
class LasReader {
 public:
  explicit LasReader(const std::filesystem::path& path);

  const LasHead& head() const { return head_; }
  /// The cloud, once. What does not come along goes to `lost`, in words.
  PointCloud read(Log* log, std::vector<std::string>& lost);

 private:
  struct Column {
    LasField field;
    std::unique_ptr<std::atomic<bool>> used, rounded;  // a value other than zero; one that its type cannot hold
    Attribute attribute;
  };
  struct ColorBits {
    std::atomic<std::uint32_t> all = 0, unequal = 0;  // bits that are set; and that differ between a value's bytes
  };
  void checkCount() const;
  void readPoints();
  void grow(std::size_t to);
  void decode(const std::byte* rows, std::size_t base, std::size_t count);
  void decodeColors(const std::byte* rows, std::size_t base, std::size_t count);
  void placePoints();
  void placeColors();
  void takeNormals(Log* log);
  void takeColumns(std::vector<std::string>& lost);
  void takeTail();

  ChunkedFile file_;
  LasHead head_;
  std::vector<Column> columns_;
  BareVector<std::array<std::int32_t, 3>> places_;
  BareVector<std::array<std::uint16_t, 3>> colors_;
  ColorBits colorBits_;
  std::shared_ptr<LasBaggage> baggage_;
  PointCloud cloud_;
};

}  // namespace palpate
