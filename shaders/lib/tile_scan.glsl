// One tile of a reduce-then-scan (Merrill and Grimshaw 2009, section 3). In the second half each workgroup adds up the
// sums of the preceding tiles and scans its own. Adding up costs tiles^2 / 2 reads in total, which stay in cache and
// below the scan's own traffic up to about 10,000 tiles (20 million values); it saves a third pass.
#ifndef PALPATE_LIB_TILE_SCAN_GLSL
#define PALPATE_LIB_TILE_SCAN_GLSL

#extension GL_EXT_control_flow_attributes : require
#extension GL_KHR_shader_subgroup_ballot : require
#include "shaders/lib/workgroup_scan.glsl"
#include "shaders/shared/prefix_scan.h"

// A subgroup takes kScanItems rows of consecutive values, so that its invocations read and write side by side. Returns
// the index of this invocation's first value; the next one is gl_SubgroupSize later.
uint firstOfTile(uint tile) {
  const uint before = tile * gl_WorkGroupSize.x + gl_SubgroupID * gl_SubgroupSize;
  return before * kScanItems + gl_SubgroupInvocationID;
}

// The sum of all values before this subgroup's; `sum` is that of this invocation's values.
uint sumBefore(Uints tileSums, uint tile, uint sum) {
  uint partial = 0;
  for (uint t = gl_LocalInvocationIndex; t < tile; t += gl_WorkGroupSize.x) partial += tileSums.at[t];
  uint before;
  workgroupExclusiveScan(partial, before);
  uint total;
  return before + subgroupBroadcastFirst(workgroupExclusiveScan(sum, total));
}

// First half: the sum of a tile.
void reduceTile(Uints values, Uints tileSums, uint tile, uint count) {
  const uint first = (tile * gl_WorkGroupSize.x) * kScanItems;
  uint sum = 0;
  for (uint item = 0; item < kScanItems; ++item) {
    const uint i = first + item * gl_WorkGroupSize.x + gl_LocalInvocationIndex;
    if (i < count) sum += values.at[i];
  }
  uint total;
  workgroupExclusiveScan(sum, total);
  if (gl_LocalInvocationIndex == 0) tileSums.at[tile] = total;
}

// Second half, in place.
void scanTile(Uints values, Uints tileSums, uint tile, uint count) {
  const uint first = firstOfTile(tile);
  uint own[kScanItems];
  uint sum = 0;
  [[unroll]] for (uint item = 0; item < kScanItems; ++item) {
    const uint i = first + item * gl_SubgroupSize;
    own[item] = i < count ? values.at[i] : 0;
    sum += own[item];
  }
  uint running = sumBefore(tileSums, tile, sum);
  [[unroll]] for (uint item = 0; item < kScanItems; ++item) {
    const uint i = first + item * gl_SubgroupSize;
    uint total;
    const uint before = running + subgroupScan(own[item], total);
    if (i < count) values.at[i] = before;
    running += total;
  }
}

#endif
