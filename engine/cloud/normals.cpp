#include "engine/cloud/normals.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "engine/cloud/eigen3.hpp"
#include "engine/cloud/point_tree.hpp"
#include "engine/core/check.hpp"
#include "engine/core/parallel.hpp"

namespace palpate {
namespace {

/// A noisy neighbourhood needs more points than a clean one, whose detail they would blur. The plane's slope is off by
/// about sqrt(off / (points * along)), of the least and the middle variance; from a degree on a wider one is tried.
constexpr double kClean = 0.005;  // off / along, with 16 points
constexpr unsigned kWider = 4;    // times the points
/// It is taken where it is flatter by this, off / along of one over that of the other: noise stays as thick while the
/// place grows, whereas over an edge the points come as much farther off the plane as along it, and on a curved surface
/// more.
constexpr double kFlatter = 0.5;

struct PlaneFit {
  Vec3 normal;
  double off, along;  ///< variances, off the plane and along its narrower side, squared model units
};

/// The plane of the points `around`, some of those near `center`.
PlaneFit fitPlane(std::span<const Vec3> points, std::span<const std::uint32_t> around, const Vec3& center) {
  DVec3 mean(0);
  for (const std::uint32_t j : around) mean += DVec3(points[j]) - DVec3(center);
  const auto count = static_cast<double>(around.size());
  mean /= count;
  SymmetricMatrix3 covariance;
  for (const std::uint32_t j : around) covariance.addSquare(DVec3(points[j]) - DVec3(center) - mean);
  const Eigen3 eigen = eigenSymmetric(covariance);
  return {Vec3(eigen.vectors[0]), eigen.values[0] / count, eigen.values[1] / count};
}

}  // namespace

void fitNearestPlanes(std::span<const Vec3> points, std::span<const std::uint32_t> which, unsigned neighbours,
                      std::span<Vec3> normals, NeighbourGraph& graph, unsigned threads) {
  if (which.empty()) return;
  const auto most = [&](std::size_t count) { return std::min(std::max<std::size_t>(count, 1), points.size()); };
  const std::size_t few = most(neighbours), many = most(std::size_t{neighbours} * kWider);
  const PointTree tree(points);
  parallelFor(which.size(), threads, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> around(many);
    std::vector<double> squaredDistances(many);
    const auto fit = [&](std::uint32_t i, std::size_t count) {
      const std::size_t found = tree.nearest(points[i], {around.data(), count}, {squaredDistances.data(), count});
      PALPATE_CHECK_EQ(found, count);
      return fitPlane(points, {around.data(), count}, points[i]);
    };
    for (std::size_t n = begin; n < end; ++n) {
      const std::uint32_t i = which[n];
      const PlaneFit near = fit(i, few);
      const auto edges = graph.of(i);
      std::ranges::fill(edges, NeighbourGraph::kNobody);
      std::copy_n(around.begin(), std::min(few, edges.size()), edges.begin());
      normals[i] = near.normal;
      if (near.off <= kClean * near.along) continue;
      if (const PlaneFit wide = fit(i, many); wide.off * near.along < kFlatter * near.off * wide.along)
        normals[i] = wide.normal;
    }
  });
}

void estimateNormals(PointCloud& cloud, unsigned neighbours, unsigned threads) {
  const Places places = distinctPlaces(cloud.positions);
  const std::size_t count = places.positions.size();
  std::vector<Vec3> normals(count);
  NeighbourGraph graph{.degree = std::max(neighbours, 1u), .neighbours = {}};
  graph.neighbours.resize(graph.degree * count);
  std::vector<std::uint32_t> all(count);
  std::iota(all.begin(), all.end(), 0u);
  fitNearestPlanes(places.positions, all, neighbours, normals, graph, threads);
  orientNormals(places.positions, normals, graph, threads);
  spreadNormals(cloud, places, normals);
}

void spreadNormals(PointCloud& cloud, const Places& places, std::span<const Vec3> normals) {
  cloud.normals.resize(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) cloud.normals[i] = normals[places.placeOf[i]];
}

void fillMissingNormals(PointCloud& cloud, std::span<const std::size_t> missing, std::string_view cloudName, Log* log,
                        double mostMissing) {
  const auto total = static_cast<double>(cloud.size());
  if (missing.size() == cloud.size() || static_cast<double>(missing.size()) > mostMissing * total) {
    if (log) log->say("{}: {} of {} normals are zero; all are ignored", cloudName, missing.size(), cloud.size());
    cloud.normals.clear();
    return;
  }
  std::vector<bool> isMissing(cloud.size(), false);
  for (const std::size_t i : missing) isMissing[i] = true;
  std::vector<Vec3> known, knownNormals;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (isMissing[i]) continue;
    known.push_back(cloud.positions[i]);
    knownNormals.push_back(cloud.normals[i]);
  }
  const Places places = distinctPlaces(known);
  std::vector<Vec3> normalAt(places.positions.size());
  for (std::size_t i = 0; i < known.size(); ++i) normalAt[places.placeOf[i]] = knownNormals[i];
  const PointTree tree(places.positions);
  for (const std::size_t i : missing) {
    std::uint32_t nearest = 0;
    double squaredDistance = 0;
    tree.nearest(cloud.positions[i], {&nearest, 1}, {&squaredDistance, 1});
    cloud.normals[i] = normalAt[nearest];
  }
  if (log)
    log->say("{}: {} of {} points have no normal and take their nearest neighbour's", cloudName, missing.size(),
             cloud.size());
}

}  // namespace palpate
