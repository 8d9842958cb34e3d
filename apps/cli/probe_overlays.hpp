// Drawing of a tick in a picture.
#pragma once

#include <optional>

#include "engine/core/brush.hpp"
#include "engine/core/units.hpp"
#include "engine/render/frame_options.hpp"
#include "haptics/trace.hpp"

namespace palpate {

/// The HIP as a ball; in contact also the proxy as a disc on the surface, the force as an arrow, and the tool of the
/// brush as an outline, or the ball that a hand holds in matter. `origin`: of the cloud; `longestSide`: of its box,
/// model units.
struct HeldTool {
  std::optional<BrushOptions> brush;
  double ballRadius = 0;  ///< model units; 0: no ball
};
Overlays overlaysOf(const TraceRow& row, const DVec3& origin, double longestSide, const HeldTool& tool);

}  // namespace palpate
