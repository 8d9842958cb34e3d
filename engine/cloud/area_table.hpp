// Converts a density over the unit square into a map that distributes points by it: first the row by the marginal
// distribution, then the position in the row by the conditional one (Devroye 1986, section XI.2). The density is
// bilinear between grid nodes and inverted exactly, so the map has no seams at the cells.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "engine/core/vec.hpp"

namespace palpate {

class AreaTable {
 public:
  /// `density` must be positive. It is evaluated at (rows + 1) x (columns + 1) nodes, from several threads.
  AreaTable(std::size_t rows, std::size_t columns, const std::function<double(const DVec2&)>& density,
            unsigned threads);

  /// (0..1, 0..1), uniform, to (row 0..1, column 0..1), distributed by the density. Monotone in each coordinate.
  DVec2 operator()(const DVec2& uniform) const;

 private:
  double node(std::size_t row, std::size_t column) const { return density_[row * (columns_ + 1) + column]; }
  double cumulative(std::size_t row, std::size_t column) const { return cumulative_[row * (columns_ + 1) + column]; }

  std::size_t rows_, columns_;
  std::vector<double> density_;     // at the nodes
  std::vector<double> cumulative_;  // integral of the row from its start to the node, in cells
  std::vector<double> marginal_;    // integral of the rows' totals up to each row, in cells
};

}  // namespace palpate
