// Chooses a good position for touching an unknown model.
#pragma once

#include "engine/cloud/point_cloud.hpp"
#include "haptics/thinned_cloud.hpp"

namespace palpate {

struct TouchTarget {
  DVec3 position{0};  ///< a point of the sample, model units relative to the cloud's origin
  DVec3 normal{0};    ///< unit, outward
};

/// A point that the default camera sees, that can be reached along its normal, with flat, one-sided surroundings, and
/// near the middle of the picture; as many of these as the model allows. The same cloud gives the same target.
TouchTarget chooseTarget(const ThinnedCloud& sample, const Bounds& bounds);

}  // namespace palpate
