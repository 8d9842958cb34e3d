// Normals for clouds without normals.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

#include "engine/cloud/orientation.hpp"
#include "engine/cloud/places.hpp"
#include "engine/cloud/point_cloud.hpp"
#include "engine/core/log.hpp"

namespace palpate {

/// In double precision: the normal of the least-squares plane of the nearest `neighbours` points (Hoppe, DeRose,
/// Duchamp, McDonald and Stuetzle 1992, "Surface reconstruction from unorganized points", section 3.2), or of four
/// times as many if the points are noisy and the wider neighbourhood is flatter (neighbourhood size by noise: Mitra and
/// Nguyen 2003, "Estimating surface normals in noisy point cloud data"). Next to an edge, that of keepEdges(). Signs as
/// in orientNormals(), where up is that of the user, or findUp(). Coincident points count once. Always
/// unit length, even if the neighbours are on a line. The result does not depend on `threads`. On the GPU:
/// engine/contact/normal_estimate.hpp.
void estimateNormals(PointCloud& cloud, unsigned neighbours = 16, unsigned threads = 0, std::optional<UpAxis> up = {});

struct FittedPlane {
  Vec3 normal{0};     ///< unit, of either sign
  float off = 0;      ///< variance of the neighbours off the plane, squared model units
  float spacing = 0;  ///< local, model units
};

/// The planes of estimateNormals(), without signs, for the points of `which` alone: writes the planes, and the nearest
/// points into the graph. `points` must be distinct.
void fitNearestPlanes(std::span<const Vec3> points, std::span<const std::uint32_t> which, unsigned neighbours,
                      std::span<FittedPlane> planes, NeighbourGraph& graph, unsigned threads = 0);

/// The normals of the planes, of either sign. If a plane cuts across an edge (its points lie farther off it than those
/// of planes near by), the mean of the normals there instead, weighted by the flatness of their neighbourhoods and by
/// the point's distance from their planes, over the normals similar to the one of the largest weight, which is that of
/// its own side. Surfaces that are smooth over eight spacings are unchanged. (After the idea that a point next to an
/// edge has a neighbourhood on one side alone: Li, Schnabel, Klein, Cheng, Dang and Jin 2010, "Robust normal estimation
/// for point clouds with sharp features"; the weights are ours.) One plane for each of `points`.
std::vector<Vec3> keepEdges(std::span<const Vec3> points, std::span<const FittedPlane> planes, unsigned threads = 0);

/// Orients the normals like their planes, which are oriented by orientNormals().
void signNormals(std::span<const Vec3> points, std::span<const FittedPlane> planes, const NeighbourGraph& graph,
                 std::span<Vec3> normals, unsigned threads, UpAxis up);

/// Gives each point the normal of its place in `places`.
void spreadNormals(PointCloud& cloud, const Places& places, std::span<const Vec3> normals, unsigned threads = 0);

/// Gives the points in `missing` the normal of the nearest point that has one. If more than `mostMissing` of all points
/// lack one, the cloud loses its normals instead. Reports this to `log` under the name `cloudName`.
void fillMissingNormals(PointCloud& cloud, std::span<const std::size_t> missing, std::string_view cloudName, Log* log,
                        double mostMissing = 0.1);

}  // namespace palpate
