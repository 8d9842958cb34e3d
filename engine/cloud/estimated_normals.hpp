// Which normals are estimates and not of the file, so that they are not written to it.
#pragma once

#include "engine/cloud/point_cloud.hpp"

namespace palpate {

/// Adds or removes the comment that the normals of `cloud` are estimates and not of its file.
void markNormalsAsEstimated(PointCloud& cloud, bool are);
bool areNormalsEstimated(const PointCloud& cloud);

}  // namespace palpate
