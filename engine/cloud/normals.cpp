#include "engine/cloud/normals.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <iterator>
#include <numbers>
#include <vector>

#include "engine/cloud/eigen3_many.hpp"
#include "engine/cloud/point_tree.hpp"
#include "engine/core/check.hpp"
#include "engine/core/parallel_collect.hpp"

namespace palpate {
namespace {

/// A noisy neighbourhood needs more points than a clean one, whose detail they would blur. The error of the plane's
/// slope is about sqrt(off / (points * along)), of the smallest and the middle variance; from one degree on a wider
/// neighbourhood is tried.
constexpr double kClean = 0.005;  // off / along, with 16 points
constexpr unsigned kWider = 4;    // factor of the number of points
/// The wider one is used if it is flatter by this factor, comparing off / along of both: noise keeps its thickness as
/// the neighbourhood grows, whereas across an edge the points move off the plane in proportion to its size, and on a
/// curved surface faster.
constexpr double kFlatter = 0.5;

/// Edge detection: offset of points from a plane, in local spacings, beyond the flattest plane near by (six times its
/// variance, since the minimum of many may be noise), where an edge starts to count and where it is certain. On a
/// sphere of ten spacings the offset is 0.1 everywhere, at a cube's edge 0.43 and a spacing beside it 0.3.
constexpr double kEdgeFrom = 0.12, kEdgeSurely = 0.2, kEdgeOfNoise = 6;
/// Next to an edge normals are weighted by the flatness of their neighbourhoods and by the point's height over their
/// planes: the distance in spacings at which a weight falls to 1/e, and the additional share of the noise variance.
constexpr double kOwnFlatness = 0.06, kOwnFlatnessOfNoise = 0.5;
constexpr double kOwnHeight = 0.08, kOwnHeightOfNoise = 3;
constexpr double kSameFace = 0.9;  // minimum cosine between normals of one face
constexpr double kMinWeight = 1e-6;
constexpr std::size_t kTogether = 256;   // points whose spreads are solved at once
constexpr std::size_t kAroundEdge = 50;  // points, four spacings wide

struct PlaneFit {
  Vec3 normal;
  double off, along;  ///< variances, off the plane and along its narrower side, squared model units
};

double wendland(double r) { return r < 1 ? std::pow(1 - r, 4) * (4 * r + 1) : 0; }

/// The spread of the points `around`, relative to the near `center`.
SymmetricMatrix3 spreadOf(std::span<const Vec3> points, std::span<const std::uint32_t> around, const Vec3& center) {
  DVec3 mean(0);
  for (const std::uint32_t j : around) mean += DVec3(points[j]) - DVec3(center);
  const auto count = static_cast<double>(around.size());
  mean /= count;
  SymmetricMatrix3 covariance;
  for (const std::uint32_t j : around) covariance.addSquare(DVec3(points[j]) - DVec3(center) - mean);
  return covariance;
}

PlaneFit planeOf(const Eigen3& spread, std::size_t points) {
  const auto count = static_cast<double>(points);
  return {Vec3(spread.vectors[0]), spread.values[0] / count, spread.values[1] / count};
}

void fitPlanes(const PointTree& tree, std::span<const Vec3> points, std::span<const std::uint32_t> which,
               unsigned neighbours, std::span<FittedPlane> planes, NeighbourGraph& graph, unsigned threads) {
  const auto most = [&](std::size_t count) { return std::min(std::max<std::size_t>(count, 1), points.size()); };
  const std::size_t few = most(neighbours), many = most(std::size_t{neighbours} * kWider);
  parallelFor(which.size(), threads, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> around(many);
    std::vector<double> squaredDistances(many);
    ManyEigen3 spreads, wideSpreads;
    std::vector<std::uint32_t> noisy;
    NearbySearch search(tree), wideSearch(tree);
    const auto spread = [&](std::uint32_t i, std::size_t count) {
      const std::size_t found = (count == few ? search : wideSearch)
                                    .nearest(points[i], {around.data(), count}, {squaredDistances.data(), count});
      PALPATE_CHECK_EQ(found, count);
      return spreadOf(points, {around.data(), count}, points[i]);
    };
    for (std::size_t first = begin; first < end; first += kTogether) {
      const auto part = which.subspan(first, std::min(kTogether, end - first));
      spreads.clear(), wideSpreads.clear(), noisy.clear();
      for (const std::uint32_t i : part) {
        spreads.add(spread(i, few));
        const double spacing = std::sqrt(std::numbers::pi * squaredDistances[few - 1] / static_cast<double>(few));
        planes[i].spacing = static_cast<float>(spacing);
        const auto edges = graph.of(i);
        std::ranges::fill(edges, NeighbourGraph::kNobody);
        std::copy_n(around.begin(), std::min(few, edges.size()), edges.begin());
      }
      spreads.solve();
      for (std::uint32_t n = 0; n < part.size(); ++n) {
        const PlaneFit fit = planeOf(spreads[n], few);
        planes[part[n]].normal = fit.normal, planes[part[n]].off = static_cast<float>(fit.off);
        if (!(fit.off > kClean * fit.along)) continue;
        noisy.push_back(n);
        wideSpreads.add(spread(part[n], many));
      }
      wideSpreads.solve();
      for (std::size_t k = 0; k < noisy.size(); ++k) {
        const PlaneFit fit = planeOf(spreads[noisy[k]], few), wide = planeOf(wideSpreads[k], many);
        if (!(wide.off * fit.along < kFlatter * fit.off * wide.along)) continue;
        FittedPlane& plane = planes[part[noisy[k]]];
        plane.normal = wide.normal, plane.off = static_cast<float>(wide.off);
      }
    }
  });
}

std::vector<Vec3> keptEdges(const PointTree& tree, std::span<const Vec3> points, std::span<const FittedPlane> planes,
                            unsigned threads) {
  PALPATE_CHECK_EQ(points.size(), planes.size());
  std::vector<Vec3> normals(points.size());
  const std::size_t most = std::min(kAroundEdge, points.size());
  parallelFor(points.size(), threads, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> around(most);
    std::vector<double> squaredDistances(most), weights(most);
    std::vector<DVec3> likes(most);
    NearbySearch search(tree);
    for (std::size_t k = begin; k < end; ++k) {
      const std::uint32_t i = tree.order()[k];
      const FittedPlane& own = planes[i];
      const double squaredSpacing = double{own.spacing} * own.spacing;
      normals[i] = own.normal;
      if (own.off <= kEdgeFrom * kEdgeFrom * squaredSpacing) continue;
      const std::size_t found = search.nearest(points[i], around, squaredDistances);
      double flattest = own.off;
      for (std::size_t n = 0; n < found; ++n) flattest = std::min(flattest, double{planes[around[n]].off});
      const double excess = (own.off - kEdgeOfNoise * flattest) / squaredSpacing;
      if (!(excess > kEdgeFrom * kEdgeFrom)) continue;
      const double flatness = kOwnFlatness * kOwnFlatness * squaredSpacing + kOwnFlatnessOfNoise * flattest;
      const double height = kOwnHeight * kOwnHeight * squaredSpacing + kOwnHeightOfNoise * flattest;
      const double reach = std::sqrt(squaredDistances[found - 1]);
      std::size_t best = 0;
      for (std::size_t n = 0; n < found; ++n) {
        const FittedPlane& other = planes[around[n]];
        const DVec3 normal(other.normal);
        const double over = glm::dot(normal, DVec3(points[around[n]]) - DVec3(points[i]));
        likes[n] = glm::dot(normal, DVec3(own.normal)) < 0 ? -normal : normal;
        weights[n] = wendland(std::sqrt(squaredDistances[n]) / reach) *
                     std::exp(-(other.off - flattest) / flatness - over * over / height);
        if (weights[n] > weights[best]) best = n;
      }
      if (!(weights[best] >= kMinWeight)) continue;
      DVec3 sum(0);
      for (std::size_t n = 0; n < found; ++n)
        if (glm::dot(likes[n], likes[best]) > kSameFace) sum += weights[n] * likes[n];
      const double share = glm::smoothstep(kEdgeFrom * kEdgeFrom, kEdgeSurely * kEdgeSurely, excess);
      normals[i] = Vec3(glm::normalize(glm::mix(DVec3(own.normal), glm::normalize(sum), share)));
    }
  });
  return normals;
}

}  // namespace

void fitNearestPlanes(std::span<const Vec3> points, std::span<const std::uint32_t> which, unsigned neighbours,
                      std::span<FittedPlane> planes, NeighbourGraph& graph, unsigned threads) {
  if (which.empty()) return;
  const PointTree tree(points, threads);
  std::vector<std::uint8_t> isWanted(points.size());
  for (const std::uint32_t i : which) isWanted[i] = 1;
  std::vector<std::uint32_t> ordered;
  std::ranges::copy_if(tree.order(), std::back_inserter(ordered), [&](std::uint32_t i) { return isWanted[i] != 0; });
  fitPlanes(tree, points, ordered, neighbours, planes, graph, threads);
}

std::vector<Vec3> keepEdges(std::span<const Vec3> points, std::span<const FittedPlane> planes, unsigned threads) {
  return keptEdges(PointTree(points, threads), points, planes, threads);
}

void signNormals(std::span<const Vec3> points, std::span<const FittedPlane> planes, const NeighbourGraph& graph,
                 std::span<Vec3> normals, unsigned threads, UpAxis up) {
  auto signedPlanes = parallelMake(planes.size(), threads, [&](std::size_t i) { return planes[i].normal; });
  orientNormals(points, signedPlanes, graph, threads, up);
  parallelFor(normals.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (glm::dot(normals[i], signedPlanes[i]) < 0) normals[i] = -normals[i];
  });
}

void estimateNormals(PointCloud& cloud, unsigned neighbours, unsigned threads, std::optional<UpAxis> up) {
  const Places places = distinctPlaces(cloud.positions, threads);
  const std::size_t count = places.positions.size();
  std::vector<FittedPlane> planes(count);
  NeighbourGraph graph{.degree = std::max(neighbours, 1u), .neighbours = {}};
  graph.neighbours.resize(graph.degree * count);
  const PointTree tree(places.positions, threads);
  fitPlanes(tree, places.positions, tree.order(), neighbours, planes, graph, threads);
  std::vector<Vec3> normals = keptEdges(tree, places.positions, planes, threads);
  signNormals(places.positions, planes, graph, normals, threads, up ? *up : findUp(cloud).up);
  spreadNormals(cloud, places, normals, threads);
}

void spreadNormals(PointCloud& cloud, const Places& places, std::span<const Vec3> normals, unsigned threads) {
  cloud.normals.resize(cloud.size());
  parallelFor(cloud.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) cloud.normals[i] = normals[places.placeOf[i]];
  });
}

void fillMissingNormals(PointCloud& cloud, std::span<const std::size_t> missing, std::string_view cloudName, Log* log,
                        double mostMissing) {
  const auto total = static_cast<double>(cloud.size());
  if (missing.size() == cloud.size() || static_cast<double>(missing.size()) > mostMissing * total) {
    if (log) log->warn("{}: {} of {} normals are zero; all are ignored", cloudName, missing.size(), cloud.size());
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
