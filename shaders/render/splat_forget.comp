#version 460
#extension GL_GOOGLE_include_directive : require
// Clears the marks of changed buckets once the discs near the listed cells are measured: at the cost of the cells.
#include "shaders/lib/index.glsl"
#include "shaders/render/cell_lists.glsl"

layout(push_constant, scalar) uniform Push { SplatForgetArgs args; };

void main() {
  const uint i = threadIndex();
  if (i < args.listed) args.changed.at[bucketOf(args.grid, args.cells.at[i]) / 32] = 0;
}
