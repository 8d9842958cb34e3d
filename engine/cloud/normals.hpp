// Normals for clouds that come without.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/log.hpp"

namespace palpate {

/// Hoppe, DeRose, Duchamp, McDonald and Stuetzle 1992, "Surface reconstruction from unorganized points", section 3: the
/// normal of the plane that fits the nearest `neighbours` points best, the sign carried along a minimum spanning tree
/// of the neighbour graph on which neighbouring normals turn least. In each connected part the highest point (largest
/// z) looks upwards. Coincident points count once. Always unit length, also where the neighbours are on a line. The
/// result does not depend on `threads`.
void estimateNormals(PointCloud& cloud, unsigned neighbours = 16, unsigned threads = 0);

/// Gives the points in `missing` the normal of the nearest point that has one. When more than `mostMissing` of all
/// points have none, the cloud loses its normals instead. Says through `log` what was done, under the name `cloudName`.
void fillMissingNormals(PointCloud& cloud, std::span<const std::size_t> missing, std::string_view cloudName, Log* log,
                        double mostMissing = 0.1);

}  // namespace palpate
