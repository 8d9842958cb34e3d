#version 460
#extension GL_GOOGLE_include_directive : require
// Writes every point's index into its bucket, in the order of arrival.
#include "shaders/lib/index.glsl"
#include "shaders/shared/spatial_hash.h"

layout(push_constant, scalar) uniform Push { HashPlaceArgs args; };

void main() {
  const uint i = threadIndex();
  if (i >= args.count) return;
  args.order.at[args.ranges.at[args.keys.at[i]].x + args.arrivals.at[i]] = i;
}
