// Cells of a cubic grid by Morton codes of 63 bits (Morton 1966): cells that share all but the last 3 k bits form a
// cell of 2^k times the side, so that one sort serves grids of many sizes.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <functional>

#include "engine/core/parallel_collect.hpp"
#include "engine/core/parallel_radix_sort.hpp"
#include "engine/core/vec.hpp"

namespace palpate {

inline constexpr int kMortonBits = 21;  // of each coordinate
/// Cells extend this far to both sides of the origin; positions farther away are in the outermost cells.
inline constexpr std::int32_t kMortonReach = 1 << (kMortonBits - 1);

/// The bits of a coordinate, with two zeros after each.
inline std::uint64_t spreadBits(std::uint64_t v) {
  v &= 0x1FFFFF;
  v = (v | v << 32) & 0x001F00000000FFFFull;
  v = (v | v << 16) & 0x001F0000FF0000FFull;
  v = (v | v << 8) & 0x100F00F00F00F00Full;
  v = (v | v << 4) & 0x10C30C30C30C30C3ull;
  return (v | v << 2) & 0x1249249249249249ull;
}

/// Inverse of spreadBits(): every third bit.
inline std::uint64_t gatherBits(std::uint64_t v) {
  v &= 0x1249249249249249ull;
  v = (v | v >> 2) & 0x10C30C30C30C30C3ull;
  v = (v | v >> 4) & 0x100F00F00F00F00Full;
  v = (v | v >> 8) & 0x001F0000FF0000FFull;
  v = (v | v >> 16) & 0x001F00000000FFFFull;
  return (v | v >> 32) & 0x1FFFFF;
}

inline std::uint64_t mortonCode(const IVec3& cell) {
  return spreadBits(static_cast<std::uint64_t>(cell.x)) | spreadBits(static_cast<std::uint64_t>(cell.y)) << 1 |
         spreadBits(static_cast<std::uint64_t>(cell.z)) << 2;
}

/// The coordinates, from 0 on, of the cell of side `side` that contains a position.
inline IVec3 mortonCell(const Vec3& place, float side) {
  IVec3 cell;
  for (int k = 0; k < 3; ++k) {
    const auto reach = static_cast<float>(kMortonReach);
    const float at = std::clamp(place[k] / side, -reach, reach - 1);
    const auto whole = static_cast<std::int32_t>(at);  // towards zero: std::floor() is a call on older processors
    cell[k] = whole - (at < static_cast<float>(whole) ? 1 : 0) + kMortonReach;
  }
  return cell;
}

/// The cell of a code.
inline IVec3 mortonCellOf(std::uint64_t code) {
  IVec3 cell;
  for (int k = 0; k < 3; ++k) cell[k] = static_cast<std::int32_t>(gatherBits(code >> k));
  return cell;
}

/// Sorting by Morton codes, with many threads.
/// Sorts by codeOf(value), a Morton code of 63 bits; stable for any number of `threads` (0: one per core). The first
/// bit of a coordinate gives the side of the middle that a cell is on. The bits below it are its complement, down to
/// those that distinguish the cells of the cloud; only these are sorted by.
template <class T, class CodeOf>
void sortByMorton(BareVector<T>& values, unsigned threads, CodeOf&& codeOf) {
  constexpr int kFirst = 3 * (kMortonBits - 1);
  constexpr std::uint64_t kBelow = (std::uint64_t{1} << kFirst) - 1;
  constexpr std::uint64_t kEachBelow = 0x1249249249249249 & kBelow;  // of one coordinate
  const auto telling = [&](std::size_t begin, std::size_t end) {
    std::uint64_t bits = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint64_t code = codeOf(values[i]);
      bits |= (code & kBelow) ^ kEachBelow * (7 ^ code >> kFirst);
    }
    return bits;
  };
  const std::uint64_t bits = parallelReduce(values.size(), threads, std::uint64_t{0}, telling, std::bit_or<>());
  const int kept = 3 * ((static_cast<int>(std::bit_width(bits)) + 2) / 3);
  parallelRadixSort(values, static_cast<unsigned>(kept + 3), threads, [&](const T& value) {
    const std::uint64_t code = codeOf(value);
    return code >> kFirst << kept | (code & ((std::uint64_t{1} << kept) - 1));
  });
}

/// A cubic grid without bounds: values sorted by cell, and the occupied cells around a position.
/// The cells of values that are sorted by the Morton codes of their cells (morton.hpp), and a hash table with open
/// addressing that finds them. Its entries are cubes of eight cells, which are consecutive in the order of the codes,
/// so that the surroundings of a cell take eight look-ups instead of 27. Safe to query from any thread.
class MortonCells {
 public:
  MortonCells() = default;
  /// codeOf(k): the ascending codes of `count` values, fewer than 2^32; called from several threads. `threads`: 0: one
  /// per core.
  template <class CodeOf>
  MortonCells(std::size_t count, unsigned threads, CodeOf&& codeOf)
      : begins_(parallelRuns(count, threads, [&](std::size_t k) { return codeOf(k) == codeOf(k - 1); })),
        codes_(parallelMake(begins_.size() - 1, threads, [&](std::size_t cell) { return codeOf(begins_[cell]); })) {
    fillTable(threads);
  }

  std::size_t count() const { return codes_.size(); }
  std::uint64_t code(std::size_t cell) const { return codes_[cell]; }
  /// The values of a cell: the first one, and one past the last.
  std::size_t begin(std::size_t cell) const { return begins_[cell]; }
  std::size_t end(std::size_t cell) const { return begins_[cell + 1]; }

  /// Calls use(number) for each occupied cell among the one with these coordinates and the 26 around it.
  template <class Use>
  void forEachAround(const IVec3& at, Use&& use) const {
    // Of the two cubes along each axis one holds two of the three cells, the other one the third.
    constexpr std::array<std::array<std::uint8_t, 2>, 3> kHalves{{{0x55, 0xAA}, {0x33, 0xCC}, {0x0F, 0xF0}}};
    std::array<std::array<std::uint64_t, 2>, 3> bits;
    std::array<std::array<std::uint8_t, 2>, 3> masks;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t own = at[static_cast<int>(k)], first = (own - 1) >> 1;
      const bool odd = (own & 1) != 0;
      bits[k] = {spread(first) << k, spread(first + 1) << k};
      masks[k] = {odd ? kAll : kHalves[k][1], odd ? kHalves[k][0] : kAll};
    }
    for (std::size_t z = 0; z < 2; ++z)
      for (std::size_t y = 0; y < 2; ++y)
        for (std::size_t x = 0; x < 2; ++x) {
          const Cube* cube = find(bits[0][x] | bits[1][y] | bits[2][z]);
          if (!cube) continue;
          const std::uint32_t wanted = cube->occupied & masks[0][x] & masks[1][y] & masks[2][z];
          for (std::uint32_t left = wanted; left != 0; left &= left - 1)
            use(cube->first + static_cast<std::uint32_t>(std::popcount(cube->occupied & ((left & -left) - 1))));
        }
  }

 private:
  struct Cube {
    std::uint64_t code;      // of its cells, without their last three bits
    std::uint32_t first;     // index of its first cell
    std::uint32_t occupied;  // a bit for each of the eight
  };
  static constexpr std::uint64_t kNone = ~std::uint64_t{0};
  static constexpr std::uint8_t kAll = 0xFF;

  static std::uint64_t spread(std::int32_t coordinate) { return spreadBits(static_cast<std::uint64_t>(coordinate)); }
  /// Cubes that share all but the last bit of each coordinate are adjacent in the table, as those around a cell mostly
  /// are.
  std::size_t slotOf(std::uint64_t code) const {
    return static_cast<std::size_t>(((code >> 3) * 0x9E3779B97F4A7C15u) >> 20 << 3 | (code & 7)) & (cubes_.size() - 1);
  }
  const Cube* find(std::uint64_t code) const {
    for (std::size_t slot = slotOf(code); cubes_[slot].code != kNone; slot = (slot + 1) & (cubes_.size() - 1))
      if (cubes_[slot].code == code) return &cubes_[slot];
    return nullptr;
  }

  void fillTable(unsigned threads);

  BareVector<std::size_t> begins_{0};
  BareVector<std::uint64_t> codes_;
  BareVector<Cube> cubes_{Cube{kNone, 0, 0}};  // size is a power of two; never full
};

}  // namespace palpate
