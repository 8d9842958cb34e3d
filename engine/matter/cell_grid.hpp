// Cells of a box, and particles in their order: a counting build, so that what is near in space is near in memory.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/core/vec.hpp"

namespace palpate {

/// From 0 to `size`, m. Along a periodic axis what leaves through one face comes in by the other.
struct MatterBox {
  Vec3 size{0};
  std::array<bool, 3> periodic{};
};

/// Cells half as wide as `reach`, or a little more, so that they fill the box.
class CellGrid {
 public:
  /// `reach`: m; along periodic axes the box is 2.5 of it at least.
  CellGrid(const MatterBox& box, float reach);

  /// Fills `order` with the numbers of `places`, cell by cell, and in their own order within a cell: x changes first,
  /// then y. What stands outside of the box, or nowhere, counts to a cell at its border.
  void sort(std::span<const Vec4> places, std::vector<std::uint32_t>& order);

  /// Calls run(begin, end, image) for ranges in the order that sort() made, which hold all that is within the reach of
  /// `place`, and more. What stands in a range is met at its place plus shiftOf(image).
  template <class Run>
  void forEachRun(const Vec3& place, Run&& run) const;

  /// Of the neighbour beyond the border of a periodic axis, m.
  Vec3 shiftOf(std::uint32_t image) const { return shifts_[image]; }
  static constexpr std::uint32_t kImages = 27, kItself = 13;  ///< the image that is shifted by nothing

 private:
  // Cells from `begin` to before `end` along an axis, and the image that they belong to: 0, 1 (itself) or 2.
  struct Piece {
    int begin = 0, end = 0, image = 1;
  };
  struct Pieces {
    std::array<Piece, 3> piece;
    int count = 0;
  };
  Pieces piecesAlong(int axis, int cell) const;
  IVec3 cellOf(const Vec3& place) const;
  std::size_t numberOf(const IVec3& cell) const {
    return (static_cast<std::size_t>(cell.z) * static_cast<std::size_t>(cells_.y) + static_cast<std::size_t>(cell.y)) *
               static_cast<std::size_t>(cells_.x) +
           static_cast<std::size_t>(cell.x);
  }

  MatterBox box_;
  IVec3 cells_{1};
  Vec3 cellsPerMetre_{0};
  std::array<Vec3, kImages> shifts_{};
  std::vector<std::uint32_t> first_;   // of each cell in the order, and their number at the end
  std::vector<std::uint32_t> cellAt_;  // of each place
};

template <class Run>
void CellGrid::forEachRun(const Vec3& place, Run&& run) const {
  const IVec3 cell = cellOf(place);
  const Pieces alongX = piecesAlong(0, cell.x), alongY = piecesAlong(1, cell.y), alongZ = piecesAlong(2, cell.z);
  for (int k = 0; k < alongZ.count; ++k)
    for (int z = alongZ.piece[k].begin; z < alongZ.piece[k].end; ++z)
      for (int j = 0; j < alongY.count; ++j)
        for (int y = alongY.piece[j].begin; y < alongY.piece[j].end; ++y)
          for (int i = 0; i < alongX.count; ++i) {
            const Piece& x = alongX.piece[i];
            const int image = x.image + 3 * alongY.piece[j].image + 9 * alongZ.piece[k].image;
            run(first_[numberOf({x.begin, y, z})], first_[numberOf({x.end - 1, y, z}) + 1],
                static_cast<std::uint32_t>(image));
          }
}

}  // namespace palpate
