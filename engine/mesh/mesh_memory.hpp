// What a mesh needs on the GPU, known before anything is uploaded.
#pragma once

#include <cstdint>

#include "engine/mesh/mesh_plan.hpp"

namespace palpate {

class Device;

/// What a mesh needs on the GPU, bytes.
struct MeshMemory {
  std::uint64_t blocks = 0;  ///< how many are there; not bytes
  std::uint64_t cloud = 0;   ///< points in two orders
  std::uint64_t index = 0;
  std::uint64_t lattice = 0;  ///< the table and what the blocks hold
  std::uint64_t mesh = 0;     ///< vertices and triangles: an estimate on the safe side
  std::uint64_t total() const { return cloud + index + lattice + mesh; }
};
MeshMemory predictMeshMemory(const PointCloud& cloud, const MeshPlan& plan);

/// Throws OutOfGpuMemory, with the numbers, where the device has less memory than that.
void requireMeshMemory(const Device& device, const MeshMemory& memory);

}  // namespace palpate
