// Paths of known true depth, since they are defined on the true surface and not on the points.
#pragma once

#include "engine/core/units.hpp"
#include "haptics/path.hpp"
#include "haptics/study/touch_truth.hpp"

namespace palpate {

/// A path, and the time window of what it is made for.
struct TruthPath {
  Path path;
  double from_s = 0, to_s = 0;
};

struct TruthPathOptions {
  double depth_mm = 1;  ///< of the HIP below the true surface
  double lift_mm = 5;   ///< above it, where the path begins and ends, without contact
  double speed_mm_per_s = 50;
  double length_mm = 30;  ///< of a slide, along the true surface
};

/// Down at 25 mm/s, a short rest, along a geodesic in the direction of `towards` (any vector that is not normal to the
/// surface) at the depth and speed of the options, and up. The window is the motion along the geodesic. Where the
/// surface bends so sharply that the HIP would be nearer to another part of it, and the truth would jump, the depth is
/// reduced, but not below a third. Where the surface breaks off at an edge the path continues straight, out of the
/// edge, at full depth.
TruthPath truthSlide(const TouchTruth& truth, const SurfacePoint& start, const DVec3& towards, const ModelScale& scale,
                     const TruthPathOptions& options);

/// Down at the speed of the options to their depth, a rest of a quarter of a second, and up. The window is the second
/// half of the rest.
TruthPath truthPress(const SurfacePoint& start, const ModelScale& scale, const TruthPathOptions& options);

/// Five times down at the speed of the options and up again. The window is the whole path.
TruthPath truthTaps(const SurfacePoint& start, const ModelScale& scale, const TruthPathOptions& options);

}  // namespace palpate
