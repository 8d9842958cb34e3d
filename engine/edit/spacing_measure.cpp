#include "engine/edit/spacing_measure.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "engine/core/check.hpp"
#include "engine/core/widest_lanes.hpp"
#include "engine/edit/resampling.hpp"
#include "engine/spatial/cell_groups.hpp"
#include "shaders/shared/weight.h"

namespace palpate {

namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

struct NearNormals {
  const double *x, *y, *z;
};
struct Terms {
  double *weight, *distance;  // 0, and infinity, for a point of another sheet
  std::uint32_t* sector;
};

PALPATE_WIDEST_LANES
void termsOf(const NearPoints& near, const NearNormals& normals, const Frame3& frame, double radius,
             const Terms& terms) {
  const double *x = near.x(), *y = near.y(), *z = near.z(), *nx = normals.x, *ny = normals.y, *nz = normals.z;
  const double ux = frame.u.x, uy = frame.u.y, uz = frame.u.z, vx = frame.v.x, vy = frame.v.y, vz = frame.v.z,
               wx = frame.n.x, wy = frame.n.y, wz = frame.n.z;
  double *weight = terms.weight, *distance = terms.distance;
  std::uint32_t* sector = terms.sector;
  const std::size_t count = near.size();
#pragma GCC ivdep
  for (std::size_t k = 0; k < count; ++k) {
    const double length = std::sqrt(x[k] * x[k] + y[k] * y[k] + z[k] * z[k]);
    const double cosine = wx * nx[k] + wy * ny[k] + wz * nz[k];
    const double w = shared::wendland(length / radius);
    weight[k] = cosine > static_cast<double>(shared::kSameSheet) ? w : 0.0;
    distance[k] = cosine > static_cast<double>(shared::kSameSheet) && length > 0 ? length : kFar;
  }
#pragma GCC ivdep
  for (std::size_t k = 0; k < count; ++k)
    sector[k] = shared::sectorOf(static_cast<float>(x[k] * ux + y[k] * uy + z[k] * uz),
                                 static_cast<float>(x[k] * vx + y[k] * vy + z[k] * vz));
}

}  // namespace

void SpacingMeasure::gather(const SortedGrid& grid, const GatheredPoints::Balls& balls, std::span<const Vec3> normals) {
  points_.gather(grid, balls);
  const std::span<const std::uint32_t> numbers = points_.numbers();
  if (normalX_.size() < numbers.size()) {
    for (std::vector<double>* each : {&normalX_, &normalY_, &normalZ_, &nearX_, &nearY_, &nearZ_, &weight_, &distance_})
      each->resize(2 * numbers.size());
    sector_.resize(2 * numbers.size());
  }
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const Vec3& normal = normals[numbers[i]];
    normalX_[i] = double{normal.x};
    normalY_[i] = double{normal.y};
    normalZ_[i] = double{normal.z};
  }
}

double SpacingMeasure::at(const DVec3& place, const DVec3& normal, double radius) {
  points_.near(place, radius, near_);
  for (std::size_t k = 0; k < near_.size(); ++k) {
    const std::uint32_t i = near_.indices()[k];
    nearX_[k] = normalX_[i];
    nearY_[k] = normalY_[i];
    nearZ_[k] = normalZ_[i];
  }
  termsOf(near_, {nearX_.data(), nearY_.data(), nearZ_.data()}, frameAround(normal), radius,
          {weight_.data(), distance_.data(), sector_.data()});
  double weights = 0;
  SectorDistances nearest;
  nearest.fill(kFar);
  for (std::size_t k = 0; k < near_.size(); ++k) {
    weights += weight_[k];
    double& inSector = nearest[sector_[k]];
    inSector = std::min(inSector, distance_[k]);
  }
  return std::max(shared::spacingFrom(radius, std::max(weights, static_cast<double>(shared::kMinWeights))),
                  sectorSpacing(nearest));
}

namespace {

// Whether no point with a lower number is nearer than `radius`, which is far less than a cell. A bucket's points are in
// the order of their numbers, and of many that coincide the first is found soon.
bool isFirstWithin(const SortedGrid& grid, std::span<const Vec3> positions, double radius, std::uint32_t point) {
  const DVec3 place(positions[point]);
  bool first = true;
  const CellBox box = cellsAround(grid.grid(), place, radius);
  if (box.cells() > SortedGrid::kFewCells) {  // so far out that cells are finer than the coordinates
    grid.forEachNear(place, radius, [&](const SortedGrid::Placed& near) { first = first && near.number >= point; });
    return first;
  }
  grid.forEachBucket(box, [&](std::span<const SortedGrid::Placed> points) {
    for (auto near = points.begin(); first && near != points.end() && near->number < point; ++near) {
      const DVec3 offset = DVec3(near->position) - place;
      first = !(glm::dot(offset, offset) < radius * radius);
    }
  });
  return first;
}

// Calls body(begin, end) for parts of `count`, on all threads.
template <class Body>
void forEachPart(SortedGrid& grid, std::size_t count, Body&& body) {
  constexpr std::size_t kPart = 4096;
  grid.team().forEach((count + kPart - 1) / kPart,
                      [&](std::size_t part) { body(part * kPart, std::min(count, (part + 1) * kPart)); });
}

}  // namespace

std::vector<float> measuredSpacings(SortedGrid& grid, std::span<const Vec3> positions, std::span<const Vec3> normals,
                                    double radius, std::vector<float> known) {
  PALPATE_CHECK_EQ(known.size(), positions.size());
  if (std::ranges::find(known, 0.0f) == known.end()) return known;
  const double least = static_cast<double>(shared::kMinSpacing) * radius;
  const double most = static_cast<double>(shared::kMaxSpacing) * radius;
  // Only the first of coincident points counts, so that thousands at one position cost no more than as many elsewhere.
  std::vector<std::uint8_t> counts(positions.size());
  forEachPart(grid, positions.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      counts[i] = isFirstWithin(grid, positions, least, static_cast<std::uint32_t>(i));
  });
  std::optional<SortedGrid> distinct;
  if (std::ranges::find(counts, 0) != counts.end()) {
    distinct.emplace(grid.grid(), static_cast<unsigned>(grid.threads()), SortedGrid::CellTags::on);
    distinct->build(positions, counts);
  }
  const SortedGrid& counted = distinct ? *distinct : grid;
  // In the order of the index, so that points of a cell are together.
  const std::span<const SortedGrid::Placed> all = grid.placed();
  forEachPart(grid, all.size(), [&](std::size_t begin, std::size_t end) {
    thread_local CellGroups groups;
    thread_local SpacingMeasure measure;
    thread_local std::vector<SortedGrid::Placed> points;
    points.clear();
    for (const SortedGrid::Placed& point : all.subspan(begin, end - begin))
      if (known[point.number] == 0) points.push_back(point);
    groups.assign(grid.grid(), points.size(),
                  [&](std::size_t i) { return std::pair(DVec3(points[i].position), radius); });
    for (const CellGroups::Group& group : groups.groups()) {
      measure.gather(counted, group.balls, normals);
      for (const std::uint32_t i : groups.members(group)) {
        const std::uint32_t point = points[i].number;
        const double spacing = measure.at(DVec3(points[i].position), DVec3(normals[point]), radius);
        known[point] = static_cast<float>(std::clamp(spacing, least, most));
      }
    }
  });
  return known;
}

}  // namespace palpate
