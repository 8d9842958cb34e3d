// The patch of points copied from the GPU for ticks whose answer is late. Its users need no GPU.
#pragma once

#include <span>

#include "engine/core/vec.hpp"

namespace palpate {

/// The points around a position, as in the live cloud. Model units, relative to the cloud's origin.
struct CarriedPatch {
  Vec3 centre{0};
  double reach = 0;              ///< every point nearer than this to the centre is included
  std::span<const Vec4> points;  ///< two for each point: position with the id's bits, normal
  bool thinned = false;          ///< the points were subsampled
};

}  // namespace palpate
