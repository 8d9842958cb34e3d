#include "engine/study/surface_before.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "engine/cloud/eigen3.hpp"
#include "engine/core/check.hpp"

namespace palpate {

namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();
constexpr std::size_t kFirstDisc = 4, kLastDisc = 16;  // neighbours whose discs give a point's area
constexpr std::size_t kOfAPlace = 6;                   // number of points whose mean spacing is the local spacing
constexpr std::size_t kTangentPlanes = 4;
constexpr std::size_t kFewestOfAFit = 6, kOfAFit = 16;  // neighbours that define a local plane or sphere
constexpr double kOneSheet = -0.3;                      // minimum cosine between the normals of a sheet around an edge
constexpr double kEdgeOn = 0.5;      // cosine of a normal and a direction up to which the normal shows no side
constexpr double kCrushed = 0.1;     // share of the original area below which a crushed piece shows no side
constexpr double kDetermined = 0.5;  // product of correlations below which the motion shows none

// The algebraic sphere that fits positions and normals (Guennebaud, Germann and Gross 2008, "Dynamic sampling and
// rendering of algebraic point set surfaces", section 3), relative to a local origin.
class SphereFit {
 public:
  void add(const DVec3& p, const DVec3& n, double w) {
    weights_ += w, places_ += w * p, normals_ += w * n;
    squares_ += w * glm::dot(p, p), heights_ += w * glm::dot(p, n);
  }
  double height(const DVec3& x) const {
    const double spread = squares_ - glm::dot(places_, places_) / weights_;
    const double bend = heights_ - glm::dot(places_, normals_) / weights_;
    const double q = spread > 0 ? 0.5 * bend / spread : 0;
    const DVec3 l = (normals_ - 2 * q * places_) / weights_;
    const double c = -(glm::dot(l, places_) + q * squares_) / weights_;
    const double root = std::sqrt(std::max(0.0, glm::dot(l, l) - 4 * q * c));
    const double slope = glm::length(l + 2 * q * x) + root;
    return slope > 0 ? 2 * (c + glm::dot(l, x) + q * glm::dot(x, x)) / slope : 0;
  }

 private:
  double weights_ = 0, squares_ = 0, heights_ = 0;
  DVec3 places_{0}, normals_{0};
};

double wendlandWeight(double r) { return r < 1 ? std::pow(1 - r, 4) * (4 * r + 1) : 0; }

// Normal of the plane through `places`, of either sign; empty if there are too few, or if they do not span a plane.
std::optional<DVec3> planeThrough(std::span<const DVec3> places) {
  if (places.size() < kFewestOfAFit) return std::nullopt;
  DVec3 mean(0);
  for (const DVec3& place : places) mean += place / static_cast<double>(places.size());
  SymmetricMatrix3 spread;
  for (const DVec3& place : places) spread.addSquare(place - mean);
  const Eigen3 axes = eigenSymmetric(spread);
  if (axes.values[0] > 0.25 * axes.values[1]) return std::nullopt;
  return axes.vectors[0];
}

}  // namespace

NearestPoints nearestTo(const PointTree& tree, const DVec3& place) {
  NearestPoints near;
  near.count = tree.nearest(Vec3(place), near.points, near.squared);
  return near;
}

bool tellsItsSide(const PointCloud& cloud, const PointTree& tree, std::uint32_t point) {
  const DVec3 facing(cloud.normals[point]), place(cloud.positions[point]);
  const NearestPoints near = nearestTo(tree, place);
  std::vector<DVec3> offsets;
  for (std::size_t k = 0; k < near.count && offsets.size() < kOfAFit; ++k)
    if (glm::dot(DVec3(cloud.normals[near.points[k]]), facing) > 0)
      offsets.push_back(DVec3(cloud.positions[near.points[k]]) - place);
  const std::optional<DVec3> plane = planeThrough(offsets);
  return plane && std::abs(glm::dot(*plane, facing)) > kEdgeOn;
}

std::optional<DVec3> carriedNormal(const PointCloud& before, const PointTree& tree, std::span<const PointState> after,
                                   std::uint32_t point) {
  const DVec3 facing(before.normals[point]), place(before.positions[point]), moved(after[point].position);
  const Frame3 frame = frameAround(facing);
  const NearestPoints near = nearestTo(tree, place);
  std::vector<DVec2> were;
  std::vector<DVec3> are;
  DVec2 wereMean(0);
  DVec3 areMean(0);
  for (std::size_t k = 0; k < near.count && were.size() < kOfAFit; ++k) {
    const std::uint32_t other = near.points[k];
    if (after[other].gone || glm::dot(DVec3(before.normals[other]), facing) <= 0) continue;
    const DVec3 was = DVec3(before.positions[other]) - place;
    wereMean += were.emplace_back(glm::dot(was, frame.u), glm::dot(was, frame.v));
    areMean += are.emplace_back(DVec3(after[other].position) - moved);
  }
  const auto count = static_cast<double>(were.size());
  double uu = 0, uv = 0, vv = 0;
  DVec3 alongU(0), alongV(0);
  SymmetricMatrix3 spread;
  for (std::size_t k = 0; k < were.size(); ++k) {
    const DVec2 was = were[k] - wereMean / count;
    const DVec3 is = are[k] - areMean / count;
    uu += was.x * was.x, uv += was.x * was.y, vv += was.y * was.y;
    alongU += was.x * is, alongV += was.y * is;
    spread.addSquare(is);
  }
  const double det = uu * vv - uv * uv;
  if (det <= 0) return std::nullopt;
  const DVec3 across = glm::cross(vv * alongU - uv * alongV, uu * alongV - uv * alongU) / (det * det);
  const double area = glm::length(across);
  if (area < kCrushed) return std::nullopt;
  // Of the two canonical correlations: how well the positions before determine those along the surface after.
  const Eigen3 axes = eigenSymmetric(spread);
  const double correlated = glm::length(glm::cross(alongU, alongV)) / std::sqrt(det * axes.values[1] * axes.values[2]);
  if (correlated < kDetermined) return std::nullopt;
  return across / area;
}

SurfaceBefore::SurfaceBefore(const PointCloud& before)
    : before_(before), tree_(before.positions), spacings_(before.size()) {
  PALPATE_CHECK(before.hasNormals());
}

double SurfaceBefore::spacingOf(std::uint32_t point) {
  double& spacing = spacings_[point];
  if (spacing > 0) return spacing;
  const NearestPoints near = nearestTo(tree_, position(point));
  double areas = 0;
  std::size_t discs = 0;
  std::vector<Vec3> places{before_.positions[point]};  // coincident points count once
  for (std::size_t i = 0; i < near.count && places.size() <= kLastDisc; ++i) {
    const Vec3& place = before_.positions[near.points[i]];
    if (glm::dot(normal(near.points[i]), normal(point)) <= 0 || std::ranges::find(places, place) != places.end())
      continue;
    places.push_back(place);
    if (places.size() <= kFirstDisc) continue;
    // The disc to the k-th neighbour holds k areas where points lie at random, k + 1/2 where they lie on a lattice.
    areas += std::numbers::pi * near.squared[i] / (static_cast<double>(places.size() - 1) + 0.25);
    ++discs;
  }
  spacing = discs > 0 ? std::sqrt(areas / static_cast<double>(discs)) : kFar;  // a single point cannot be crowded
  return spacing;
}

double SurfaceBefore::spacingAt(const DVec3& place, const DVec3& facing) {
  const NearestPoints near = nearestTo(tree_, place);
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < near.count && count < kOfAPlace; ++i) {
    if (glm::dot(normal(near.points[i]), facing) <= 0) continue;
    sum += spacingOf(near.points[i]);
    ++count;
  }
  if (count == 0 && near.count > 0) return spacingOf(near.points[0]);
  return count > 0 ? sum / static_cast<double>(count) : kFar;
}

double SurfaceBefore::heightAt(const DVec3& place) const {
  const NearestPoints toPlace = nearestTo(tree_, place);
  if (toPlace.count == 0) return kFar;
  const std::uint32_t first = toPlace.points[0];
  const DVec3 middle = position(first), facing = normal(first);
  const auto sameSheet = [&](std::uint32_t i) { return glm::dot(normal(i), facing) > kOneSheet; };
  const NearestPoints around = nearestTo(tree_, middle);
  const double reach = 1.2 * std::sqrt(around.squared[std::min(kOfAFit, around.count) - 1]);
  SphereFit sphere;
  for (std::size_t k = 0; k < around.count; ++k) {
    const std::uint32_t i = around.points[k];
    const double r = reach > 0 ? std::sqrt(around.squared[k]) / reach : 0;
    if (sameSheet(i)) sphere.add(position(i) - middle, normal(i), wendlandWeight(r));
  }
  double highest = -kFar, own = 0;
  for (std::size_t k = 0, planes = 0; k < toPlace.count && planes < kTangentPlanes; ++k) {
    const std::uint32_t i = toPlace.points[k];
    if (!sameSheet(i)) continue;
    highest = std::max(highest, glm::dot(place - position(i), normal(i)));
    own = std::max(own, sphere.height(position(i) - middle));
    ++planes;
  }
  return std::min(sphere.height(place - middle) - own, highest);
}

}  // namespace palpate
