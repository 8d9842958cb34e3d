// GPU memory that a mesh needs, predicted before any upload.
#pragma once

#include <cstdint>

#include "engine/mesh/mesh_plan.hpp"

namespace palpate {

class Device;

/// GPU memory of a mesh, bytes.
struct MeshMemory {
  std::uint64_t blocks = 0;  ///< number of blocks; not bytes
  std::uint64_t cloud = 0;   ///< points in two orders
  std::uint64_t index = 0;
  std::uint64_t lattice = 0;  ///< the table and the contents of blocks
  std::uint64_t mesh = 0;     ///< vertices and triangles: a conservative estimate
  std::uint64_t total() const { return cloud + index + lattice + mesh; }
};
MeshMemory predictMeshMemory(const PointCloud& cloud, const MeshPlan& plan);

/// Throws OutOfGpuMemory, with both sizes, if the device has less memory.
void requireMeshMemory(const Device& device, const MeshMemory& memory);

}  // namespace palpate
