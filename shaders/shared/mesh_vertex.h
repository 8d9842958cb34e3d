#ifndef PALPATE_SHARED_MESH_VERTEX_H
#define PALPATE_SHARED_MESH_VERTEX_H
#include "shaders/shared/types.h"

PALPATE_SHARED_BEGIN

// Written by the mesh passes and drawn by the render passes. A triangle is three vertex numbers, anticlockwise as seen
// from outside.
struct MeshVertex {
  vec3 position;  // model units
  vec3 normal;    // unit, outwards
  uint color;     // RGBA8; 0 if the cloud has no colours
};
PALPATE_SIZE(MeshVertex, 28);

#ifndef __cplusplus
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer MeshVertices { MeshVertex at[]; };
#endif

PALPATE_SHARED_END
#endif
