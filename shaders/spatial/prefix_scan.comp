#version 460
#extension GL_GOOGLE_include_directive : require
// Reduce-then-scan, second half: each workgroup adds up the sums of the tiles before its own and scans its own in
// place. The adding-up costs tiles^2 / 2 reads in all, which stay in cache and below the scan's own traffic up to
// some 10,000 tiles (20 million values); it saves a third pass.
#include "shaders/shared/prefix_scan.h"
#include "shaders/lib/index.glsl"
#include "shaders/lib/workgroup_scan.glsl"

layout(push_constant, scalar) uniform Push { PrefixScanArgs args; };

void main() {
  const uint tile = workgroupIndex();
  if (tile >= args.tiles) return;

  uint partial = 0;
  for (uint t = gl_LocalInvocationIndex; t < tile; t += gl_WorkGroupSize.x) partial += args.tileSums.at[t];
  uint before;
  workgroupExclusiveScan(partial, before);

  const uint first = (tile * gl_WorkGroupSize.x + scanIndex()) * kScanItems;
  uint values[kScanItems];
  uint sum = 0;
  for (uint item = 0; item < kScanItems; ++item) {
    values[item] = first + item < args.count ? args.values.at[first + item] : 0;
    sum += values[item];
  }
  uint total;
  uint running = before + workgroupExclusiveScan(sum, total);
  for (uint item = 0; item < kScanItems; ++item) {
    if (first + item < args.count) args.values.at[first + item] = running;
    running += values[item];
  }
}
