#version 460
#extension GL_GOOGLE_include_directive : require
// Reduce-then-scan in place, second half.
#extension GL_EXT_control_flow_attributes : require
#include "shaders/shared/prefix_scan.h"
#include "shaders/lib/index.glsl"
#include "shaders/lib/tile_scan.glsl"

layout(push_constant, scalar) uniform Push { PrefixScanArgs args; };

void main() {
  const uint tile = workgroupIndex();
  if (tile >= args.tiles) return;
  const uint first = firstOfTile(tile);
  uint values[kScanItems];
  uint sum = 0;
  [[unroll]] for (uint item = 0; item < kScanItems; ++item) {
    const uint i = first + item * gl_SubgroupSize;
    values[item] = i < args.count ? args.values.at[i] : 0;
    sum += values[item];
  }
  uint running = sumBefore(args.tileSums, tile, sum);
  [[unroll]] for (uint item = 0; item < kScanItems; ++item) {
    const uint i = first + item * gl_SubgroupSize;
    const uint before = running + subgroupExclusiveAdd(values[item]);
    if (i < args.count) args.values.at[i] = before;
    running += subgroupAdd(values[item]);
  }
}
