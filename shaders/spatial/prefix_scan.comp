#version 460
#extension GL_GOOGLE_include_directive : require
// Reduce-then-scan in place, second half.
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
  for (uint item = 0; item < kScanItems; ++item) {
    values[item] = first + item < args.count ? args.values.at[first + item] : 0;
    sum += values[item];
  }
  uint running = sumBefore(args.tileSums, tile, sum);
  for (uint item = 0; item < kScanItems; ++item) {
    if (first + item < args.count) args.values.at[first + item] = running;
    running += values[item];
  }
}
