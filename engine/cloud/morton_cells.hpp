// Occupied cells of a cubic grid, found by their Morton codes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace palpate {

/// A hash table by open addressing over cells that do not change. Safe to ask from any thread.
class MortonCells {
 public:
  MortonCells() = default;
  /// Each code once, fewer than 2^32 of them.
  explicit MortonCells(std::vector<std::uint64_t> codes);

  std::size_t count() const { return codes_.size(); }
  std::uint64_t code(std::size_t cell) const { return codes_[cell]; }
  /// The number of the cell; nothing where it is not occupied.
  std::optional<std::uint32_t> find(std::uint64_t code) const {
    for (std::size_t slot = slotOf(code); slots_[slot] != kNone; slot = (slot + 1) & (slots_.size() - 1))
      if (codes_[slots_[slot]] == code) return slots_[slot];
    return std::nullopt;
  }

 private:
  static constexpr std::uint32_t kNone = 0xFFFFFFFF;
  std::size_t slotOf(std::uint64_t code) const {
    return static_cast<std::size_t>((code * 0x9E3779B97F4A7C15u) >> 20) & (slots_.size() - 1);
  }

  std::vector<std::uint64_t> codes_;
  std::vector<std::uint32_t> slots_{kNone};  // a power of two of them, never all in use
};

}  // namespace palpate
