#include "haptics/thinned_cloud.hpp"

#include <algorithm>

#include "engine/cloud/places.hpp"
#include "engine/core/error.hpp"

namespace palpate {
namespace {

constexpr std::size_t kPlaneNeighbours = 32;  // enough to average noise, few enough to follow detail
constexpr double kSameFace = 0.3;             // cosine; beyond an edge of about 70 degrees the face is another one

/// One index of each run, at a scattered position in it: a fixed stride would alias with clouds stored row by row.
std::vector<std::uint32_t> thinned(std::size_t count, std::size_t most) {
  const std::size_t run = (count + most - 1) / most;
  std::vector<std::uint32_t> chosen;
  for (std::size_t begin = 0; begin < count; begin += run) {
    const std::uint64_t scattered = ((begin / run + 1) * 0x9E3779B97F4A7C15u) >> 32;
    const std::size_t length = std::min(run, count - begin);
    chosen.push_back(static_cast<std::uint32_t>(begin + scattered % length));
  }
  return chosen;
}

std::vector<Vec3> pick(const std::vector<Vec3>& values, const std::vector<std::uint32_t>& chosen) {
  std::vector<Vec3> result;
  result.reserve(chosen.size());
  for (const std::uint32_t i : chosen) result.push_back(values[i]);
  return result;
}

/// Wendland's C2 function: 1 at 0, 0 from 1 on.
double wendland(double r) {
  const double rest = std::max(0.0, 1 - r);
  return rest * rest * rest * rest * (4 * r + 1);
}

}  // namespace

ThinnedCloud::Surfels ThinnedCloud::surfelsOf(const PointCloud& cloud, std::size_t most) {
  if (cloud.empty()) throw Error("the model has no points; a built-in path needs a surface to touch");
  if (!cloud.hasNormals())
    throw Error("the model has no normals, and a built-in path needs them; load it with estimated normals");
  const std::vector<std::uint32_t> chosen = thinned(cloud.size(), most);
  Places places = distinctPlaces(pick(cloud.positions, chosen));
  std::vector<Vec3> normals(places.positions.size(), Vec3(0));
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    Vec3& normal = normals[places.placeOf[i]];
    if (normal == Vec3(0)) normal = cloud.normals[chosen[i]];
  }
  return {std::move(places.positions), std::move(normals)};
}

ThinnedCloud::ThinnedCloud(const PointCloud& cloud, std::size_t most) : ThinnedCloud(surfelsOf(cloud, most)) {}

ThinnedCloud::ThinnedCloud(Surfels surfels)
    : positions_(std::move(surfels.positions)), normals_(std::move(surfels.normals)), tree_(positions_) {}

std::vector<NearPoint> ThinnedCloud::nearest(const DVec3& p, std::size_t count) const {
  std::vector<std::uint32_t> indices(count);
  std::vector<double> squares(count);
  const std::size_t found = tree_.nearest(Vec3(p), indices, squares);
  std::vector<NearPoint> result(found);
  for (std::size_t i = 0; i < found; ++i) result[i] = {indices[i], std::sqrt(squares[i])};
  return result;
}

std::optional<LocalPlane> ThinnedCloud::planeNear(const DVec3& p, const DVec3& facing) const {
  const std::vector<NearPoint> neighbours = nearest(p, kPlaneNeighbours);
  LocalPlane plane{.reach = neighbours.back().distance};
  const double support = plane.reach * 1.001;  // so that even the farthest has some weight
  double sum = 0;
  for (const NearPoint& neighbour : neighbours) {
    if (glm::dot(normal(neighbour.index), facing) < kSameFace) continue;
    const double weight = support > 0 ? wendland(neighbour.distance / support) : 1;
    sum += weight;
    plane.position += weight * position(neighbour.index);
    plane.normal += weight * normal(neighbour.index);
  }
  if (!(sum > 0)) return std::nullopt;
  plane.position /= sum;
  plane.normal = glm::normalize(plane.normal);  // all belong to one face, so they cannot cancel
  return plane;
}

bool ThinnedCloud::isFree(const DVec3& p, const DVec3& along, double from, double to, double slope,
                          double widest) const {
  if (!(to > 0)) return true;  // a model without extent hides nothing
  const double smallestStep = 0.01 * to;
  for (double s = from; s <= to;) {
    const double width = std::min(slope * s, widest);
    const double distance = distanceTo(p + s * along);
    if (distance < width) return false;
    s +=
        std::max((distance - width) / (1 + slope), smallestStep);  // up to there the cone cannot meet the nearest point
  }
  return true;
}

}  // namespace palpate
