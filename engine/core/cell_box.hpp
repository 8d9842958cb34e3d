#pragma once

#include "engine/core/vec.hpp"

namespace palpate {

/// Cells of a grid from one corner to the other, both included; empty at first.
struct CellBox {
  IVec3 low{0}, high{-1};

  /// Number of cells; a double, since it may exceed any integer type.
  double cells() const {
    const DVec3 sides = DVec3(high) - DVec3(low) + 1.0;
    return sides.x * sides.y * sides.z;
  }
  /// Calls visit(cell) for every cell, x fastest.
  template <class Visit>
  void forEach(Visit&& visit) const {
    for (int z = low.z; z <= high.z; ++z)
      for (int y = low.y; y <= high.y; ++y)
        for (int x = low.x; x <= high.x; ++x) visit(IVec3(x, y, z));
  }
};

}  // namespace palpate
