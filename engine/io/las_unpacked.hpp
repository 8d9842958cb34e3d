// What a LAZ file would have before its points and behind them, were it LAS.
#pragma once

#include "engine/io/las_layout.hpp"

namespace palpate {

/// Takes the records that stay, in their order.
class LasUnpacked {
 public:
  /// `head`: the bytes of the file before its points; `tailAt`: where those behind them begin. `head` must outlive it.
  LasUnpacked(const LasHeader& header, std::span<const std::byte> head, std::uint64_t tailAt)
      : header_(header), head_(head), tailAt_(tailAt) {}

  void add(const LasRecord& record);
  void addLong(const LasRecord& record);

  /// Header, records that were added, and what follows the records of the file.
  std::vector<std::byte> head() const;
  /// The long records that were added, and nothing else.
  const std::vector<std::byte>& tail() const { return tail_; }

 private:
  const LasHeader& header_;
  std::span<const std::byte> head_;
  std::uint64_t tailAt_;
  std::vector<std::byte> records_, tail_;
  std::uint32_t count_ = 0, longCount_ = 0;
};

}  // namespace palpate
