// Normals for clouds that come without.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "engine/cloud/orientation.hpp"
#include "engine/cloud/places.hpp"
#include "engine/cloud/point_cloud.hpp"
#include "engine/core/log.hpp"

namespace palpate {

/// In double precision: the normal of the plane that fits the nearest `neighbours` points best (Hoppe, DeRose, Duchamp,
/// McDonald and Stuetzle 1992, "Surface reconstruction from unorganized points", section 3.2), or the nearest three
/// times as many where the points are noisy and no less flat over the wider place (how much noise needs how many: Mitra
/// and Nguyen 2003, "Estimating surface normals in noisy point cloud data"), with signs as of orientNormals().
/// Coincident points count once. Always unit length, also where the neighbours are on a line. The result does not
/// depend on `threads`. For the same on a GPU see engine/contact/normal_estimate.hpp.
void estimateNormals(PointCloud& cloud, unsigned neighbours = 16, unsigned threads = 0);

/// Its planes, without signs, for the points of `which` alone: writes their normals, and their nearest points into the
/// graph. `points` must be distinct.
void fitNearestPlanes(std::span<const Vec3> points, std::span<const std::uint32_t> which, unsigned neighbours,
                      std::span<Vec3> normals, NeighbourGraph& graph, unsigned threads = 0);

/// Gives each point the normal of its place.
void spreadNormals(PointCloud& cloud, const Places& places, std::span<const Vec3> normals);

/// Gives the points in `missing` the normal of the nearest point that has one. When more than `mostMissing` of all
/// points have none, the cloud loses its normals instead. Says through `log` what was done, under the name `cloudName`.
void fillMissingNormals(PointCloud& cloud, std::span<const std::size_t> missing, std::string_view cloudName, Log* log,
                        double mostMissing = 0.1);

}  // namespace palpate
