#version 460
#extension GL_GOOGLE_include_directive : require
// Sum of the distances to the nearest neighbours of points that are far from all others, or in a crowd: a workgroup for
// each scans all points.
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference : require
#include "shaders/lib/index.glsl"
#include "shaders/shared/neighbour_distances.h"
#include "shaders/lib/nearest_list.glsl"

layout(push_constant, scalar) uniform Push { ScanDistancesArgs args; };

shared vec2 nearest[kScanWorkgroup];
shared uint owners[kScanWorkgroup];

void main() {
  const uint lane = gl_LocalInvocationIndex;
  const uint slot = args.left.at[workgroupIndex()];
  const vec4 point = args.cloud.positions.at[slot];
  NearestList list;
  list.count = 0;
  for (uint j = lane; j < args.cloud.slots; j += kScanWorkgroup) {
    const vec4 other = args.cloud.positions.at[j];
    const vec3 d = other.xyz - point.xyz;
    if (j != slot && floatBitsToUint(other.w) != kEmptySlot)
      keepNearest(list, args.neighbours, dot(d, d), other.xyz, point.xyz);
  }
  // The heads of the lists are merged: of all invocations the smallest, so many times.
  uint head = 0;
  vec2 sum = vec2(0);
  for (uint k = 0; k < args.neighbours; ++k) {
    nearest[lane] = head < list.count ? list.squared[head] : vec2(uintBitsToFloat(0x7f800000u), 0);
    owners[lane] = lane;
    for (uint width = kScanWorkgroup / 2; width > 0; width /= 2) {
      barrier();
      if (lane < width && isLess(nearest[lane + width], nearest[lane])) {
        nearest[lane] = nearest[lane + width];
        owners[lane] = owners[lane + width];
      }
    }
    barrier();
    sum = plus(sum, root(nearest[0]));
    if (owners[0] == lane) ++head;
    barrier();
  }
  if (lane == 0) args.distances.at[floatBitsToUint(point.w)] = sum;
}
