#ifndef PALPATE_SHARED_MESH_VERTEX_H
#define PALPATE_SHARED_MESH_VERTEX_H
#include "shaders/shared/types.h"

PALPATE_SHARED_BEGIN

// What the mesh passes make and the render passes draw. Triangles are three numbers of vertices each, anticlockwise as
// seen from outside.
struct MeshVertex {
  vec3 position;  // model units
  vec3 normal;    // unit, outwards
  uint color;     // RGBA8; 0 where the cloud has none
};
PALPATE_SIZE(MeshVertex, 28);

#ifndef __cplusplus
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer MeshVertices { MeshVertex at[]; };
#endif

PALPATE_SHARED_END
#endif
