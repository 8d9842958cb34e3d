#include "engine/select/move_points.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

#include "engine/cloud/counter_random.hpp"
#include "engine/cloud/edited_gaussians.hpp"
#include "engine/cloud/eigen3.hpp"
#include "engine/cloud/file_coordinates.hpp"
#include "engine/cloud/shortest_rotation.hpp"
#include "engine/cloud/voxel_sample.hpp"
#include "engine/core/check.hpp"
#include "engine/core/parallel.hpp"

namespace palpate {

namespace {

struct Plane {
  DVec3 normal;
  double offset;  // normal . p of its points

  double above(const DVec3& p) const { return glm::dot(normal, p) - offset; }
};

/// The least-squares plane of the points within `thickness` of one, facing alike.
template <class Points>
std::optional<Plane> fitted(const Plane& plane, const Points& points, double thickness) {
  const auto isIn = [&](const DVec3& p) { return std::abs(plane.above(p)) <= thickness; };
  DVec3 mean(0);
  double count = 0;
  for (const Vec3& point : points)
    if (isIn(DVec3(point))) mean += DVec3(point), ++count;
  if (count < 3) return std::nullopt;
  mean /= count;
  SymmetricMatrix3 spread;
  for (const Vec3& point : points)
    if (isIn(DVec3(point))) spread.addSquare(DVec3(point) - mean);
  const DVec3 normal = eigenSymmetric(spread).vectors[0];
  const double sign = glm::dot(normal, plane.normal) < 0 ? -1 : 1;
  return Plane{sign * normal, sign * glm::dot(normal, mean)};
}

}  // namespace

void movePoints(PointCloud& cloud, std::span<const DVec3> coordinates) {
  PALPATE_CHECK_EQ(coordinates.size(), cloud.size());
  if (cloud.empty()) return;
  if (isExact(cloud) || cloud.origin != DVec3(0) || cloud.storedAs.position == ScalarType::f64) {
    Bounds box{coordinates[0], coordinates[0]};
    for (const DVec3& each : coordinates) box = {glm::min(box.min, each), glm::max(box.max, each)};
    cloud.origin = originFor(box);
    cloud.exactPositions.assign(coordinates.begin(), coordinates.end());
  }
  for (std::size_t i = 0; i < cloud.size(); ++i) cloud.positions[i] = Vec3(coordinates[i] - cloud.origin);
}

std::optional<GroundPlane> findGround(const PointCloud& cloud, std::optional<UpAxis> up) {
  constexpr std::uint64_t kTrials = 2000, kSeed = 1;
  constexpr double kThickness = 0.25;                 // of the distance between the places of the sample
  constexpr double kMaxBelow = 0.05, kFewest = 0.05;  // shares of the sample
  constexpr double kSteepest = 0.5;                   // least cosine between its normal and up
  constexpr int kFits = 8;
  const VoxelSample sample = voxelSampleOf(cloud);
  const auto count = static_cast<double>(sample.places.size());
  if (sample.places.size() < 3) return std::nullopt;
  const DVec3 upwards = directionOf(up ? *up : findUp(cloud).up);
  double thickness = kThickness * sample.cell;
  Plane best{};
  double most = kFewest * count;
  for (std::uint64_t trial = 0; trial < kTrials; ++trial) {
    const auto drawn = [&](std::uint64_t k) {
      return DVec3(sample.places[randomBits(kSeed, 3 * trial + k) % sample.places.size()]);
    };
    const DVec3 a = drawn(0), across = glm::cross(drawn(1) - a, drawn(2) - a);
    const double length = glm::length(across);
    if (!(length > 0)) continue;
    DVec3 normal = across / length;
    if (glm::dot(normal, upwards) < 0) normal = -normal;
    if (glm::dot(normal, upwards) < kSteepest) continue;
    const Plane plane{normal, glm::dot(normal, a)};
    double in = 0, below = 0;
    for (const Vec3& place : sample.places) {
      const double above = plane.above(DVec3(place));
      in += std::abs(above) <= thickness ? 1 : 0;
      below += above < -thickness ? 1 : 0;
    }
    if (in > most && below <= kMaxBelow * count) best = plane, most = in;
  }
  if (best.normal == DVec3(0)) return std::nullopt;
  for (int fit = 0; fit < kFits; ++fit) {
    const std::optional<Plane> closer =
        fit < kFits / 2 ? fitted(best, sample.places, thickness) : fitted(best, cloud.positions, thickness);
    if (!closer) break;
    best = *closer;
  }
  return GroundPlane{best.normal, most / count};
}

void rotateToZ(PointCloud& cloud, const DVec3& normal) {
  if (cloud.empty()) return;
  const DQuat rotation = shortestRotation(normal, DVec3(0, 0, 1));
  const DVec3 middle = fileBoundsOf(cloud).center();
  std::vector<DVec3> coordinates(cloud.size());
  parallelFor(cloud.size(), 0, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      coordinates[i] = middle + rotation * (cloud.fileCoordinates(i) - middle);
      if (cloud.hasNormals()) cloud.normals[i] = Vec3(glm::normalize(rotation * DVec3(cloud.normals[i])));
    }
  });
  movePoints(cloud, coordinates);
  if (const GaussianRecords* const gaussians = gaussiansOf(cloud))
    cloud.storedAs.baggage = movedGaussians(*gaussians, rotation, middle, middle);
}

}  // namespace palpate
