#include "engine/mesh/mesh_memory.hpp"

#include <vector>

#include "engine/gpu/device.hpp"
#include "engine/spatial/prefix_scan.hpp"
#include "engine/spatial/spatial_hash.hpp"

namespace palpate {

namespace {

// Per block: number where the surface crosses a block diagonally, reduced because most blocks have fewer.
constexpr std::uint64_t kVerticesPerBlock = 96;
constexpr std::uint64_t kTrianglesPerBlock = 2 * kVerticesPerBlock;

}  // namespace

MeshMemory predictMeshMemory(const PointCloud& cloud, const MeshPlan& plan) {
  const shared::MeshLattice& lattice = plan.lattice;
  const double side = static_cast<double>(shared::kMeshBlockSide) * static_cast<double>(lattice.cell);
  const double reach = static_cast<double>(lattice.reach);
  std::vector<bool> there(shared::blockCount(lattice));
  std::uint64_t points = 0;
  MeshMemory memory;
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    if (!plan.uses(i)) continue;
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
        "{}: a mesh of {} blocks of 8 x 8 x 8 cells needs {} MiB, and the GPU has {} MiB; use a lower resolution",
        device.name(), memory.blocks, memory.total() >> 20, device.ownMemory() >> 20);
}

}  // namespace palpate
