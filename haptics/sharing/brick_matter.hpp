// Adapter from bricks of matter simulated on another machine to known particles.
#pragma once

#include "engine/matter/known_matter.hpp"
#include "haptics/sharing/brick_source.hpp"

namespace palpate {

/// The points of `source`, which must outlive the result, are the particles; a unit is a millimetre.
MatterNews newsOf(BrickSource& source);

}  // namespace palpate
