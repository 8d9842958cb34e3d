#version 460
#extension GL_GOOGLE_include_directive : require
// Brings the points into the order of their buckets and writes each bucket's range where neighbouring keys differ.
// Empty buckets keep the cleared range.
#include "shaders/lib/index.glsl"
#include "shaders/shared/spatial_hash.h"

layout(push_constant, scalar) uniform Push { HashReorderArgs args; };

void main() {
  const uint i = threadIndex();
  if (i >= args.count) return;
  const uint key = args.sortedKeys.at[i];
  if (i == 0 || args.sortedKeys.at[i - 1] != key) args.ranges.at[key].x = i;
  if (i + 1 == args.count || args.sortedKeys.at[i + 1] != key) args.ranges.at[key].y = i + 1;
  const uint from = args.sortedOrder.at[i];
  args.positionsOut.at[i] = args.positionsIn.at[from];
  args.normalsOut.at[i] = args.normalsIn.at[from];
}
