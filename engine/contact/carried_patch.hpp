// What is brought from the GPU for ticks whose answer is late. Who reads it needs no GPU.
#pragma once

#include <span>

#include "engine/core/vec.hpp"

namespace palpate {

/// The points around a place, as the live cloud had them. Model units, relative to the cloud's origin.
struct CarriedPatch {
  Vec3 centre{0};
  double reach = 0;              ///< every point nearer than this to the centre is there
  std::span<const Vec4> points;  ///< two for each point: position with the id's bits, normal
  bool thinned = false;          ///< only every so-manyth point is there
};

}  // namespace palpate
