#version 460
#extension GL_GOOGLE_include_directive : require
// Copies all points of a live cloud, which are in the order of its index, to the drawn cloud, in the order of their
// ids, pass 1 of 2: the present points. Discs are measured again only near changed points: when a frame is fused into a
// map, most of the map stays the same.
#include "shaders/lib/index.glsl"
#include "shaders/shared/drawn_cloud.h"

layout(push_constant, scalar) uniform Push { PlaceArgs args; };
#include "shaders/render/changed_buckets.glsl"

bool keepsDisc(vec4 measured, vec3 place, vec3 normal) {
  return distance(measured.xyz, place) <= args.keepsWithin &&
         distance(unpackSnorm4x8(floatBitsToUint(measured.w)).xyz, normal) <= kKeepsDiscTurned;
}

void main() {
  const uint slot = threadIndex();
  if (slot >= args.slots) return;
  const vec4 point = args.livePositions.at[slot];
  const uint id = floatBitsToUint(point.w);
  if (id >= args.pointCount) return;  // the slot is empty
  args.latest.at[id] = 1;
  const vec4 before = args.positions.at[id];
  const vec4 normal = args.liveNormals.at[slot];
  if (args.colored != 0) args.colors.at[id] = frameColor(floatBitsToUint(normal.w));
  args.positions.at[id] = point;
  args.normals.at[id].xyz = normal.xyz;
  if (args.marks == 0 || keepsDisc(args.measured.at[id], point.xyz, normal.xyz)) return;
  markBucketOf(before);
  markBucketOf(point);
  args.measured.at[id] = vec4(point.xyz, uintBitsToFloat(packSnorm4x8(vec4(normal.xyz, 0))));
}
