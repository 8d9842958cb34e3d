#version 460
#extension GL_GOOGLE_include_directive : require
// The bucket of every point, and the points' indices in their present order, as the input of the sort.
#include "shaders/shared/spatial_hash.h"
#include "shaders/lib/index.glsl"

layout(push_constant, scalar) uniform Push { HashKeysArgs args; };

void main() {
  const uint i = threadIndex();
  if (i >= args.count) return;
  args.keys.at[i] = bucketOfSlot(args.grid, args.positions.at[i]);
  args.order.at[i] = i;
}
