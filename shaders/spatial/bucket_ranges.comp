#version 460
#extension GL_GOOGLE_include_directive : require
// Turns the number of points of each bucket into the range of their slots: reduce-then-scan, second half. Resets the
// counts to zero for the next build.
#extension GL_EXT_control_flow_attributes : require
#include "shaders/shared/prefix_scan.h"
#include "shaders/lib/index.glsl"
#include "shaders/lib/tile_scan.glsl"

layout(push_constant, scalar) uniform Push { BucketRangesArgs args; };

void main() {
  const uint tile = workgroupIndex();
  if (tile >= args.tiles) return;
  const uint first = firstOfTile(tile);
  uint counts[kScanItems];
  uint sum = 0;
  [[unroll]] for (uint item = 0; item < kScanItems; ++item) {
    const uint i = first + item * gl_SubgroupSize;
    counts[item] = i < args.count ? args.counts.at[i] : 0;
    sum += counts[item];
  }
  uint running = sumBefore(args.tileSums, tile, sum);
  [[unroll]] for (uint item = 0; item < kScanItems; ++item) {
    const uint i = first + item * gl_SubgroupSize;
    uint total;
    const uint start = running + subgroupScan(counts[item], total);
    if (i < args.count) {
      args.ranges.at[i] = uvec2(start, start + counts[item]);
      args.counts.at[i] = 0;
    }
    running += total;
  }
}
