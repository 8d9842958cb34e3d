#version 460
#extension GL_GOOGLE_include_directive : require
// How many points each bucket holds becomes where they stand: reduce-then-scan, second half. The counts are left at
// zero for the next build.
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
  for (uint item = 0; item < kScanItems; ++item) {
    counts[item] = first + item < args.count ? args.counts.at[first + item] : 0;
    sum += counts[item];
  }
  uint running = sumBefore(args.tileSums, tile, sum);
  for (uint item = 0; item < kScanItems; ++item) {
    if (first + item < args.count) {
      args.ranges.at[first + item] = uvec2(running, running + counts[item]);
      args.counts.at[first + item] = 0;
    }
    running += counts[item];
  }
}
