#version 460
#extension GL_GOOGLE_include_directive : require
// Reduce-then-scan, first half: the sum of every tile.
#include "shaders/shared/prefix_scan.h"
#include "shaders/lib/index.glsl"
#include "shaders/lib/workgroup_scan.glsl"

layout(push_constant, scalar) uniform Push { PrefixScanArgs args; };

void main() {
  const uint tile = workgroupIndex();
  if (tile >= args.tiles) return;
  const uint first = (tile * gl_WorkGroupSize.x) * kScanItems;
  uint sum = 0;
  for (uint item = 0; item < kScanItems; ++item) {
    const uint i = first + item * gl_WorkGroupSize.x + gl_LocalInvocationIndex;
    if (i < args.count) sum += args.values.at[i];
  }
  uint total;
  workgroupExclusiveScan(sum, total);
  if (gl_LocalInvocationIndex == 0) args.tileSums.at[tile] = total;
}
