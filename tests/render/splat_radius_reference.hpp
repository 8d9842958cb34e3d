// The radii of a cloud's discs in double precision on the CPU (shaders/shared/splat_radius.h), for tests.
#pragma once

#include <vector>

#include "engine/cloud/point_cloud.hpp"

namespace palpate {

/// Possible radii in single precision, model units: a threshold decides whether a border is open.
struct RadiusRange {
  double least = 0, most = 0;
};

/// For each point; all must have normals. `spacing`: mean; `widest`: largest accepted border distance; model units.
std::vector<RadiusRange> referenceSplatRadii(const PointCloud& cloud, double spacing, double widest);

}  // namespace palpate
