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
/// and Nguyen 2003, "Estimating surface normals in noisy point cloud data"), next to an edge
/// that of keepEdges(), with signs as of orientNormals(). Coincident points count once. Always unit length, also where
/// the neighbours are on a line. The result does not depend on `threads`. For the same on a GPU see
/// engine/contact/normal_estimate.hpp.
void estimateNormals(PointCloud& cloud, unsigned neighbours = 16, unsigned threads = 0);

struct FittedPlane {
  Vec3 normal{0};     ///< unit, of either sign
  float off = 0;      ///< variance of the neighbours off the plane, squared model units
  float spacing = 0;  ///< local, model units
};

/// Its planes, without signs, for the points of `which` alone: writes them, and their nearest points into the graph.
/// `points` must be distinct.
void fitNearestPlanes(std::span<const Vec3> points, std::span<const std::uint32_t> which, unsigned neighbours,
                      std::span<FittedPlane> planes, NeighbourGraph& graph, unsigned threads = 0);

/// The normals of the planes, of either sign; but where a plane cuts across an edge, as its points tell that lie
/// farther off it than those of planes near by, the mean of normals there, weighed by how flat those places are and by
/// how near the point lies to their planes: of those that are like the one that counts most: that of its own
/// side. On what is smooth for eight spacings nothing changes.
/// (The thought, that a point next to an edge has a neighbourhood of one side alone: Li, Schnabel, Klein, Cheng, Dang
/// and Jin 2010, "Robust normal estimation for point clouds with sharp features"; the weights are ours.) One plane for
/// each of `points`.
std::vector<Vec3> keepEdges(std::span<const Vec3> points, std::span<const FittedPlane> planes, unsigned threads = 0);

/// Signs the normals as orientNormals() signs the planes that they come from.
void signNormals(std::span<const Vec3> points, std::span<const FittedPlane> planes, const NeighbourGraph& graph,
                 std::span<Vec3> normals, unsigned threads = 0);

/// Gives each point the normal of its place.
void spreadNormals(PointCloud& cloud, const Places& places, std::span<const Vec3> normals);

/// Gives the points in `missing` the normal of the nearest point that has one. When more than `mostMissing` of all
/// points have none, the cloud loses its normals instead. Says through `log` what was done, under the name `cloudName`.
void fillMissingNormals(PointCloud& cloud, std::span<const std::size_t> missing, std::string_view cloudName, Log* log,
                        double mostMissing = 0.1);

}  // namespace palpate
