// The signs of the normals that a cloud has.
#pragma once

#include <optional>

#include "engine/cloud/point_cloud.hpp"
#include "engine/cloud/up.hpp"

namespace palpate {

/// Flips normals so that neighbours agree (orientNormals()); each stays as it is, or is negated. Points at the same
/// position agree, too. `up`: of the user; empty: findUp().
void orientNormals(PointCloud& cloud, unsigned threads = 0, std::optional<UpAxis> up = {});

/// Negates all normals.
void flipNormals(PointCloud& cloud);

}  // namespace palpate
