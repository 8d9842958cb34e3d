#version 460
#extension GL_GOOGLE_include_directive : require
// Lists the points whose discs have to be measured again: those whose search visited a changed bucket.
#include "shaders/lib/index.glsl"
#include "shaders/shared/splat_radius.h"

layout(push_constant, scalar) uniform Push { SplatChangedArgs args; };
#include "shaders/render/disc_list.glsl"

bool changedWithin(vec3 center, float radius) {
  const ivec3 low = cellOf(args.cloud.grid, center - radius), high = cellOf(args.cloud.grid, center + radius);
  for (int z = low.z; z <= high.z; ++z)
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x; ++x) {
        const uint bucket = bucketOf(args.cloud.grid, ivec3(x, y, z));
        if ((args.changed.at[bucket / 32] >> bucket % 32 & 1) != 0) return true;
      }
  return false;
}

void main() {
  const uint slot = threadIndex();
  bool listed = false;
  if (slot < args.cloud.slots) {
    const vec4 point = args.cloud.positions.at[slot];
    const uint id = floatBitsToUint(point.w);
    if (id != kEmptySlot) listed = changedWithin(point.xyz, uintBitsToFloat(args.reaches.at[id] & ~kSplatListed));
  }
  listDisc(listed, slot);
}
