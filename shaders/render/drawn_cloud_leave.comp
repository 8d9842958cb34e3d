#version 460
#extension GL_GOOGLE_include_directive : require
// Pass 2 of 2: removes the points that are not in the live cloud.
#include "shaders/lib/index.glsl"
#include "shaders/shared/drawn_cloud.h"

layout(push_constant, scalar) uniform Push { PlaceArgs args; };
#include "shaders/render/changed_buckets.glsl"

void main() {
  const uint id = threadIndex();
  if (id >= args.pointCount) return;
  const bool isThere = args.latest.at[id] != 0;
  args.latest.at[id] = 0;
  if (isThere) return;
  const vec4 before = args.positions.at[id];
  if (floatBitsToUint(before.w) == kEmptySlot) return;
  markBucketOf(before);
  // A point with a NaN as position is not drawn, and a later point with this id has no measured disc.
  const vec4 nowhere = vec4(vec3(uintBitsToFloat(0x7fc00000u)), uintBitsToFloat(kEmptySlot));
  args.positions.at[id] = nowhere;
  if (args.marks != 0) args.measured.at[id] = nowhere;
}
