#version 460
#extension GL_GOOGLE_include_directive : require
// All points of a live cloud, which stand in the order of its index, into the drawn cloud, in the order of their ids.
#include "shaders/lib/index.glsl"
#include "shaders/shared/drawn_cloud.h"

layout(push_constant, scalar) uniform Push { PlaceArgs args; };

void main() {
  const uint slot = threadIndex();
  if (slot >= args.slots) return;
  const vec4 point = args.livePositions.at[slot];
  const uint id = floatBitsToUint(point.w);
  if (id >= args.pointCount) return;  // the slot is empty
  args.positions.at[id] = point;
  const vec4 normal = args.liveNormals.at[slot];
  args.normals.at[id].xyz = normal.xyz;
  if (args.colored != 0) args.colors.at[id] = frameColor(floatBitsToUint(normal.w));
}
