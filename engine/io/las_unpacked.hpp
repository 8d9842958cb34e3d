// The bytes before and behind the points of a LAZ file as they would be in an uncompressed LAS file.
#pragma once

#include "engine/io/las_layout.hpp"

namespace palpate {

/// Collects the records that are kept, in order.
class LasUnpacked {
 public:
  /// `head`: the bytes of the file before its points; `tailAt`: start of the bytes behind them. `head` must outlive the
  /// object.
  LasUnpacked(const LasHeader& header, std::span<const std::byte> head, std::uint64_t tailAt)
      : header_(header), head_(head), tailAt_(tailAt) {}

  void add(const LasRecord& record);
  void addLong(const LasRecord& record);

  /// Header, added records, and the bytes after the file's records.
  std::vector<std::byte> head() const;
  /// The added long records only.
  const std::vector<std::byte>& tail() const { return tail_; }

 private:
  const LasHeader& header_;
  std::span<const std::byte> head_;
  std::uint64_t tailAt_;
  std::vector<std::byte> records_, tail_;
  std::uint32_t count_ = 0, longCount_ = 0;
};

}  // namespace palpate
