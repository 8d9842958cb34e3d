// Distinct positions of a cloud. Real scans contain thousands of duplicates; a neighbourhood of equal points says
// nothing about the surface, and a k-d tree degenerates to a list among them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/core/bare_vector.hpp"
#include "engine/core/vec.hpp"

namespace palpate {

struct Places {
  std::vector<Vec3> positions;        ///< distinct, ordered by x, y, z
  BareVector<std::uint32_t> placeOf;  ///< for each point, the index of its position
};

/// O(N log N). Fewer than 2^32 points. The result does not depend on `threads` (0: one per core).
Places distinctPlaces(std::span<const Vec3> points, unsigned threads = 0);

}  // namespace palpate
