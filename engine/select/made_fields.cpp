#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "engine/cloud/eigen3.hpp"
#include "engine/cloud/normals.hpp"
#include "engine/cloud/spacing.hpp"
#include "engine/contact/surface.hpp"
#include "engine/core/parallel.hpp"
#include "engine/select/fields.hpp"
#include "engine/spatial/sorted_grid.hpp"

namespace palpate {

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kFewestForPlane = 3;

/// The least-squares plane of a point and its neighbours.
struct LocalPlane {
  DVec3 normal{0};  ///< unit, of either sign
  double off = 0;   ///< root of the mean squared distance from it, model units
};

class PlaneSums {
 public:
  void add(const DVec3& offset) {
    sum_ += offset;
    squares_.addSquare(offset);
    ++count_;
  }
  std::optional<LocalPlane> plane() const {
    if (count_ < kFewestForPlane) return std::nullopt;
    const auto count = static_cast<double>(count_);
    const DVec3 mean = sum_ / count;
    SymmetricMatrix3 spread = squares_;
    spread.xx -= count * mean.x * mean.x, spread.yy -= count * mean.y * mean.y, spread.zz -= count * mean.z * mean.z;
    spread.xy -= count * mean.x * mean.y, spread.xz -= count * mean.x * mean.z, spread.yz -= count * mean.y * mean.z;
    const Eigen3 eigen = eigenSymmetric(spread);
    if (!(eigen.values[1] > 0)) return std::nullopt;  // on a line
    return LocalPlane{eigen.vectors[0], std::sqrt(std::max(eigen.values[0], 0.0) / count)};
  }

 private:
  DVec3 sum_{0};
  SymmetricMatrix3 squares_;
  std::size_t count_ = 0;
};

/// Mean curvature of the algebraic sphere u0 + ul.y + u4 y.y = 0 about a point (Guennebaud, Germann and Gross 2008,
/// "Dynamic sampling and rendering of algebraic point set surfaces", section 3), as fitSphere() of
/// shaders/shared/surface.h fits it; 1 / support radius.
double sphereCurvature(const shared::SurfaceSumsOf<double>& sums) {
  const double weights = sums.offsets.w;
  const DVec3 offsets(sums.offsets), normals(sums.normals);
  const double spread = (sums.products.x - glm::dot(offsets, offsets) / weights) / weights;
  const double turn = (sums.products.y - glm::dot(offsets, normals) / weights) / weights;
  if (!(spread > 0)) return kNone;
  const double strongest = 0.5 * static_cast<double>(shared::kStrongestCurvature);
  const double u4 = std::clamp(0.5 * turn / (spread + static_cast<double>(shared::kMinSpread)), -strongest, strongest);
  const DVec3 ul = (normals - 2 * u4 * offsets) / weights;
  const double u0 = -(glm::dot(ul, offsets) + u4 * sums.products.x) / weights;
  const double slope = std::sqrt(std::max(glm::dot(ul, ul) - 4 * u0 * u4, 0.0));
  return slope > 0 ? 2 * u4 / slope : kNone;
}

/// value(i, forEachNear) for each point, where forEachNear(visit) calls visit(offset, number) for the points within the
/// radius, the point itself included.
template <class ValueOf>
std::vector<double> overNeighbourhoods(const PointCloud& cloud, double radius, unsigned threads, ValueOf&& valueOf) {
  std::vector<double> values(cloud.size(), kNone);
  if (!(radius > 0)) return values;  // all points coincide
  SortedGrid grid(makeHashGrid(Vec3(0), radius, cloud.size()), threads);
  grid.build(cloud.positions);
  constexpr std::size_t kBlock = 1024;
  parallelBlocks(cloud.size(), kBlock, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const DVec3 center(cloud.positions[i]);
      values[i] = valueOf(i, [&](auto&& visit) {
        grid.forEachNear(center, radius,
                         [&](const SortedGrid::Placed& near) { visit(DVec3(near.position) - center, near.number); });
      });
    }
  });
  return values;
}

std::vector<double> heights(const PointCloud& cloud, UpAxis up) {
  std::vector<double> values(cloud.size());
  const DVec3 along = directionOf(up);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = glm::dot(along, cloud.fileCoordinates(i));
  return values;
}

std::vector<double> curvatures(const PointCloud& cloud, double radius, double mm_per_unit, unsigned threads) {
  PointCloud oriented;
  if (!cloud.hasNormals()) {
    oriented.positions = cloud.positions;
    estimateNormals(oriented, 16, threads);
  }
  const std::vector<Vec3>& normals = cloud.hasNormals() ? cloud.normals : oriented.normals;
  return overNeighbourhoods(cloud, radius, threads, [&](std::size_t i, auto&& forEachNear) {
    shared::SurfaceSumsOf<double> sums{};
    const DVec3 facing(normals[i]);
    std::size_t count = 0;
    forEachNear([&](const DVec3& offset, std::uint32_t number) {
      const DVec3 d = offset / radius, n(normals[number]);
      const double squared = glm::dot(d, d);
      const double w = wendland(std::sqrt(squared)) * shared::facingWeight(glm::dot(n, facing));
      if (!(w > 0)) return;
      sums.offsets += w * DVec4(d, 1.0);
      sums.normals += DVec4(w * n, 1.0);
      sums.products += w * DVec2(squared, glm::dot(d, n));
      ++count;
    });
    return count < kFewestForPlane ? kNone : sphereCurvature(sums) / (radius * mm_per_unit);
  });
}

}  // namespace

std::vector<double> madeField(const PointCloud& cloud, MadeField field, const FieldOptions& options) {
  const auto up = [&] { return options.up ? *options.up : findUp(cloud).up; };
  if (field == MadeField::height) return heights(cloud, up());
  const double radius = options.radius > 0
                            ? options.radius
                            : static_cast<double>(shared::kSupportSpacings) * meanSpacing(cloud, options.threads);
  const double radius_mm = radius * options.mm_per_unit;
  if (field == MadeField::curvature) return curvatures(cloud, radius, options.mm_per_unit, options.threads);
  if (field == MadeField::density)
    return overNeighbourhoods(cloud, radius, options.threads, [&](std::size_t, auto&& forEachNear) {
      std::size_t count = 0;
      forEachNear([&](const DVec3&, std::uint32_t) { ++count; });
      return static_cast<double>(count - 1) / (std::numbers::pi * radius_mm * radius_mm);
    });
  const DVec3 along = field == MadeField::verticality ? directionOf(up()) : DVec3(0);
  return overNeighbourhoods(cloud, radius, options.threads, [&](std::size_t, auto&& forEachNear) {
    PlaneSums sums;
    forEachNear([&](const DVec3& offset, std::uint32_t) { sums.add(offset); });
    const auto plane = sums.plane();
    if (!plane) return kNone;
    return field == MadeField::roughness ? plane->off * options.mm_per_unit
                                         : 1 - std::abs(glm::dot(plane->normal, along));
  });
}

}  // namespace palpate
