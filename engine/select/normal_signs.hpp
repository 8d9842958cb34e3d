// The signs of the normals that a cloud has.
#pragma once

#include "engine/cloud/point_cloud.hpp"

namespace palpate {

/// Flips normals so that neighbours agree (orientNormals()); each stays as it is, or is negated. Points at the same
/// position agree, too.
void orientNormals(PointCloud& cloud, unsigned threads = 0);

/// Negates all normals.
void flipNormals(PointCloud& cloud);

}  // namespace palpate
