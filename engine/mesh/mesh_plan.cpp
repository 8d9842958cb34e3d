#include "engine/mesh/mesh_plan.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/cloud/counter_random.hpp"
#include "engine/core/check.hpp"
#include "engine/gpu/device.hpp"
#include "engine/spatial/prefix_scan.hpp"
#include "engine/spatial/spatial_hash.hpp"

namespace palpate {

namespace {

constexpr double kMostBlocks = 1u << 26;
// More spacings within a support radius give no better surface, only more to look at.
constexpr double kMostSpacings = 5;
constexpr std::uint64_t kChoice = 0x6d657368;  // which points a share takes

// Of each block: vertices and triangles where the surface crosses it askew, less what most blocks do not reach.
constexpr std::uint64_t kVerticesPerBlock = 96;
constexpr std::uint64_t kTrianglesPerBlock = 2 * kVerticesPerBlock;

}  // namespace

bool MeshPlan::looksAt(std::uint32_t point) const { return share >= 1 || randomUnit(kChoice, point) < share; }

MeshPlan planMesh(const Bounds& bounds, double spacing, const MeshOptions& options) {
  PALPATE_CHECK_LE(1u, options.lattice);
  PALPATE_CHECK_LE(options.lattice, kFinestLattice);
  MeshPlan plan{.surface = options.surface};
  const double side = bounds.longestSide();
  const double wanted = options.radius > 0 ? options.radius : static_cast<double>(shared::kSupportSpacings) * spacing;
  // A cloud without extent has one place to look at, and any cell will do.
  const double cell = side > 0 ? side / options.lattice : wanted > 0 ? wanted / 4 : 1.0;
  const double radius = std::max(wanted, kLeastRadius_cells * cell);
  // The skin of the density lies anywhere within the radius, so cells are needed one further out.
  const double reach = radius + (options.surface == MeshSurface::density ? cell : 0);

  // Half a cell off the box, so that flat sides of a model that fills it do not lie on nodes.
  const double margin = (std::ceil(reach / cell) + std::ceil(options.room * side / cell) + 0.5) * cell;
  DVec3 blocks(0);
  for (int k = 0; k < 3; ++k)
    blocks[k] = std::ceil(((bounds.max[k] - bounds.min[k] + 2 * margin) / cell + 1) / shared::kMeshBlockSide);
  if (!(blocks.x * blocks.y * blocks.z <= kMostBlocks))
    throw Error(
        "a lattice of {} cells along the longest side is too fine for points that lie {:.3g} apart; take a coarser one",
        options.lattice, spacing);
  if (spacing > 0) plan.share = std::min(1.0, std::pow(kMostSpacings * spacing / radius, 2));
  const double looked = spacing > 0 ? spacing / std::sqrt(plan.share) : radius / 4;
  plan.lattice = {.origin = Vec3(bounds.min - margin),
                  .cell = static_cast<float>(cell),
                  .blocks = shared::uvec3(blocks),
                  .radius = static_cast<float>(radius),
                  .reach = static_cast<float>(reach),
                  .densityScale = static_cast<float>(7 / std::numbers::pi * std::pow(looked / radius, 2))};
  return plan;
}

MeshMemory predictMeshMemory(const PointCloud& cloud, const MeshPlan& plan) {
  const shared::MeshLattice& lattice = plan.lattice;
  const double side = static_cast<double>(shared::kMeshBlockSide) * static_cast<double>(lattice.cell);
  const double reach = static_cast<double>(lattice.reach);
  std::vector<bool> there(shared::blockCount(lattice));
  std::uint64_t points = 0;
  MeshMemory memory;
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    if (!plan.looksAt(i)) continue;
    ++points;
    const DVec3 place = DVec3(cloud.positions[i]) - DVec3(lattice.origin);
    const DVec3 most = DVec3(lattice.blocks) - 1.0;
    const UVec3 low(glm::clamp(glm::floor((place - reach) / side), DVec3(0), most));
    const UVec3 high(glm::clamp(glm::floor((place + reach) / side), DVec3(0), most));
    for (std::uint32_t z = low.z; z <= high.z; ++z)
      for (std::uint32_t y = low.y; y <= high.y; ++y)
        for (std::uint32_t x = low.x; x <= high.x; ++x) {
          const std::uint32_t number = shared::blockNumber(lattice, {x, y, z});
          if (there[number]) continue;
          const DVec3 first = DVec3(x, y, z) * side;
          const DVec3 away = place - glm::clamp(place, first, first + (side - static_cast<double>(lattice.cell)));
          if (glm::dot(away, away) >= reach * reach) continue;
          there[number] = true;
          ++memory.blocks;
        }
  }
  constexpr std::uint64_t kWord = 4, kVec4 = 16;
  const std::uint64_t table = shared::blockCount(lattice) + 1;
  memory.cloud = (2 * 2 * kVec4 + (cloud.hasColors() ? kWord : 0)) * points;
  memory.index = SpatialHash::predictedBytes(points);
  memory.lattice =
      table * kWord + PrefixScan::scratchBytes(table) +
      memory.blocks * kWord * (shared::kMeshBlockNodes + shared::kMeshCaseWords + 2 * shared::kMeshMaskWords + 4);
  memory.mesh =
      memory.blocks * (kVerticesPerBlock * sizeof(shared::MeshVertex) + kTrianglesPerBlock * 3 * sizeof(std::uint32_t));
  return memory;
}

void requireMeshMemory(const Device& device, const MeshMemory& memory) {
  if (memory.total() > device.ownMemory())
    throw OutOfGpuMemory(
        "{}: a mesh of {} blocks of 8 x 8 x 8 cells needs {} MiB, and the GPU has {} MiB; take a coarser --lattice",
        device.name(), memory.blocks, memory.total() >> 20, device.ownMemory() >> 20);
}

}  // namespace palpate
