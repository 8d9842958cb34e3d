// Reads LAS and LAZ: points by columns, in blocks, on all cores.
#pragma once

#include "engine/core/log.hpp"
#include "engine/io/chunked_file.hpp"
#include "engine/io/cloud_format.hpp"
#include "engine/io/copc.hpp"
#include "engine/io/las_columns.hpp"
#include "engine/io/las_layout.hpp"
#include "engine/io/laz_layout.hpp"

namespace palpate {

/// The part of a file before its first point.
struct LasHead {
  LasHeader header;
  LasPointFormat format;
  std::vector<std::byte> bytes;
  std::vector<std::byte> descriptors;  ///< of extra bytes
  std::vector<LasExtraField> extra;
  std::vector<std::string> comments;  ///< as in StoredAs
  std::optional<LazLayout> packing;   ///< set if the points are compressed
};

/// Reads front to back. Throws FileError with the byte of the error.
class LasReader {
 public:
  explicit LasReader(const std::filesystem::path& path);

  const LasHead& head() const { return head_; }
  /// Reads the cloud; call once. Appends to `lost`, in words, what is not kept.
  PointCloud read(Log* log, std::vector<std::string>& lost, const CloudReadOptions& options = {});

 private:
  /// The bytes behind the points.
  struct Tail {
    std::vector<std::byte> bytes;
    std::uint64_t at = 0;
  };
  void checkCount() const;
  Tail readPlain(LasColumns& columns, unsigned threads);
  Tail readPacked(LasColumns& columns, Log* log, std::vector<std::string>& lost);
  std::shared_ptr<LasBaggage> packBaggage(const Tail& tail);

  ChunkedFile file_;
  LasHead head_;
};

}  // namespace palpate
