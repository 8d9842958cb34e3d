// Which side of a connected surface is its outside.
#pragma once

#include <vector>

#include "engine/cloud/up.hpp"
#include "engine/core/bare_vector.hpp"
#include "engine/core/vec.hpp"

namespace palpate {

struct FacingPoint {
  Vec3 position{0}, normal{0};
  float reach = 0;  ///< mean distance to its neighbours, model units
};

/// Whether the normals of a connected surface, which agree with each other, face inwards. The surface is seen from the
/// six directions of the axes, through depth maps with cells of about three spacings: each point in front of a cell
/// votes with the share of its normal that faces the viewer, so that a closed surface faces outwards however many
/// points float in it or around it. The view from above counts five times: an open sheet faces up, also a room without
/// a ceiling that is wider than it is high. If the votes balance, as for a wall, the surface faces frontOf(up); if it
/// lies along that, too, the positive direction of the third axis. Points whose reach is more than three times the
/// median do not vote. A room that was scanned from inside, with its ceiling, faces in: its sides are flat, and the
/// contents between them were seen from the middle. The result does not depend on `threads`.
bool facesInwards(BareVector<FacingPoint> surface, UpAxis up, unsigned threads);

}  // namespace palpate
