#version 460
#extension GL_GOOGLE_include_directive : require
// Brings the points into the order of their buckets and, within a bucket, of their arrival: one pass less than
// hash_settle.comp, but the order differs every time.
#include "shaders/lib/index.glsl"
#include "shaders/shared/spatial_hash.h"

layout(push_constant, scalar) uniform Push { HashScatterArgs args; };

void main() {
  const uint i = threadIndex();
  if (i >= args.count) return;
  const uint to = args.ranges.at[args.keys.at[i]].x + args.arrivals.at[i];
  args.positionsOut.at[to] = args.positionsIn.at[i];
  args.normalsOut.at[to] = args.normalsIn.at[i];
}
