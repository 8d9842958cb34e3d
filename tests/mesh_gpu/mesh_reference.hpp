// Marching cubes in double precision on the CPU: the algorithm of shaders/mesh.
#pragma once

#include "engine/cloud/point_cloud.hpp"
#include "engine/mesh/mesh.hpp"
#include "engine/mesh/mesh_plan.hpp"

namespace palpate {

/// The mesh of all points that the plan uses, with vertices and triangles in the order of the GPU's. Keeps every node
/// of the lattice, so it is for small ones. `threads`: 0 is one per core.
Mesh meshReference(const PointCloud& cloud, const MeshPlan& plan, unsigned threads = 0);

}  // namespace palpate
