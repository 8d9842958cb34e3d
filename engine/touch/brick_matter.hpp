// What has come of matter that somebody else simulates, brick by brick, as its particles.
#pragma once

#include "engine/matter/known_matter.hpp"
#include "engine/motion/brick_source.hpp"

namespace palpate {

/// The points of `source`, which outlives it, are particles; a unit is a millimetre.
MatterNews newsOf(BrickSource& source);

}  // namespace palpate
