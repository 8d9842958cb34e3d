#include "engine/mesh/mesh_plan.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/cloud/counter_random.hpp"
#include "engine/cloud/even_points.hpp"
#include "engine/core/check.hpp"
#include "engine/core/error.hpp"

namespace palpate {

namespace {

constexpr double kMaxBlocks = 1u << 26;
// Points of a square lattice whose side is the support radius.
const int kSidePoints = static_cast<int>(shared::kSupportSpacings) + 1, kFewestPoints = kSidePoints * kSidePoints;
// More spacings within a support radius give no better surface, only more points to visit.
constexpr double kMaxSpacings = 5;
constexpr std::uint64_t kChoice = 0x6d657368;  // seed for the choice of points

}  // namespace

bool MeshPlan::uses(std::uint32_t point) const {
  if (point < chosen.size()) return chosen[point];
  return share >= 1 || randomUnit(kChoice, point) < share;
}

MeshPlan planMesh(const Bounds& bounds, double spacing, const MeshOptions& options) {
  PALPATE_CHECK_LE(1u, options.resolution);
  PALPATE_CHECK_LE(options.resolution, kMaxResolution);
  MeshPlan plan{.surface = options.surface};
  const double side = bounds.longestSide();
  const double wanted = options.radius > 0 ? options.radius : static_cast<double>(shared::kSupportSpacings) * spacing;
  if (!(options.radius > 0) && side > 0 && wanted > side)
    throw Error(
        "points {:.3g} apart on a model {:.3g} long are too few for a surface, which needs at least {}: its support "
        "radius, four spacings, must not exceed the model; add points, or use a smaller radius",
        spacing, side, kFewestPoints);
  // A cloud without extent is a single position: any cell size works.
  const double cell = side > 0 ? side / options.resolution : wanted > 0 ? wanted / 4 : 1.0;
  const double radius = std::max(wanted, kMinRadius_cells * cell);
  // The skin of the density may lie anywhere within the radius, which requires one more cell.
  const double reach = radius + (options.surface == MeshSurface::density ? cell : 0);

  // Half a cell of offset, so that the flat sides of a model that fills its box do not lie on nodes.
  const double margin = (std::ceil(reach / cell) + std::ceil(options.room * side / cell) + 0.5) * cell;
  DVec3 blocks(0);
  for (int k = 0; k < 3; ++k)
    blocks[k] = std::ceil(((bounds.max[k] - bounds.min[k] + 2 * margin) / cell + 1) / shared::kMeshBlockSide);
  if (!(blocks.x * blocks.y * blocks.z <= kMaxBlocks))
    throw Error("a resolution of {} cells along the longest side is too fine for points {:.3g} apart; use a lower one",
                options.resolution, spacing);
  if (spacing > 0) plan.share = std::min(1.0, std::pow(kMaxSpacings * spacing / radius, 2));
  const double usedSpacing = spacing > 0 ? spacing / std::sqrt(plan.share) : radius / 4;
  plan.lattice = {.origin = Vec3(bounds.min - margin),
                  .cell = static_cast<float>(cell),
                  .blocks = shared::uvec3(blocks),
                  .radius = static_cast<float>(radius),
                  .reach = static_cast<float>(reach),
                  .densityScale = static_cast<float>(7 / std::numbers::pi * std::pow(usedSpacing / radius, 2))};
  return plan;
}

MeshPlan thinned(MeshPlan plan, const PointCloud& cloud) {
  constexpr double kNearlyAll = 0.9;
  const auto distance = static_cast<float>(plan.lattice.radius / kMaxSpacings);
  if (plan.surface == MeshSurface::density || cloud.empty() || !(distance > 0)) return plan;
  const BareVector<std::uint32_t> even = evenlySpaced(cloud.positions, cloud.normals, distance);
  plan.share = static_cast<double>(even.size()) / static_cast<double>(cloud.size());
  if (plan.share > kNearlyAll) {
    plan.share = 1;
    return plan;
  }
  plan.chosen.assign(cloud.size(), false);
  for (const std::uint32_t point : even) plan.chosen[point] = true;
  return plan;
}

}  // namespace palpate
