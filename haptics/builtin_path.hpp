// Paths that fit any model: they choose a suitable position on it.
#pragma once

#include <span>
#include <string_view>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/units.hpp"
#include "haptics/path.hpp"

namespace palpate {

std::span<const std::string_view> builtinPathNames();

/// In file coordinates; the same cloud gives the same path. The cloud needs normals, except for `orbit`.
/// `press`: from 3 mm outside straight down to `penetration_mm` inside, where it rests and ends.
/// `slide`: down to 1 mm inside, then 20 mm along the surface; ends in contact.
/// `scan`: 5 x 5 taps 4 mm apart, 1 mm deep, from 2 mm outside.
/// `orbit`: once around the model in two seconds, in the plane of x and z, without touching it.
/// Throws UsageError for another name, listing these, and for a penetration that is not positive; Error for a cloud
/// without points or normals.
Path builtinPath(std::string_view name, const PointCloud& cloud, const ModelScale& scale, double penetration_mm = 2.0);

/// Parameters of a ball's path in matter.
struct MatterPlace {
  Bounds fill;            ///< initial extent of the matter, model units
  DVec3 up{0, 1, 0};      ///< unit
  double ballRadius = 0;  ///< model units
};

/// press: from above into the matter, until the ball is submerged by `penetration_mm`, and stays; stir: the same, then
/// four circles, and out again. Throws UsageError for another name.
Path builtinPathInMatter(std::string_view name, const MatterPlace& place, const ModelScale& scale,
                         double penetration_mm);

}  // namespace palpate
