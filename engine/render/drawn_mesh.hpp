#pragma once

#include "engine/cloud/point_cloud.hpp"
#include "engine/gpu/buffer.hpp"
#include "shaders/shared/mesh_vertex.h"

namespace palpate {

/// A mesh on the GPU as input of a frame. Its owner keeps it until the frame is done.
struct DrawnMesh {
  DeviceAddress vertices;   ///< shared::MeshVertex
  DeviceAddress triangles;  ///< three uint32 each
  std::uint32_t triangleCount;
  bool hasColors;
  Bounds bounds;
  double cell;  ///< size of a lattice cell, model units: no triangle is larger
};

}  // namespace palpate
