// One tile of a reduce-then-scan (Merrill and Grimshaw 2009, section 3), second half: each workgroup adds up the sums of
// the tiles before its own and scans its own. The adding-up costs tiles^2 / 2 reads in all, which stay in cache and
// below the scan's own traffic up to some 10,000 tiles (20 million values); it saves a third pass.
#ifndef PALPATE_LIB_TILE_SCAN_GLSL
#define PALPATE_LIB_TILE_SCAN_GLSL

#include "shaders/lib/workgroup_scan.glsl"
#include "shaders/shared/prefix_scan.h"

// Where this invocation's kScanItems values begin.
uint firstOfTile(uint tile) { return (tile * gl_WorkGroupSize.x + scanIndex()) * kScanItems; }

// The sum of all values before this invocation's own, which add up to `sum`.
uint sumBefore(Uints tileSums, uint tile, uint sum) {
  uint partial = 0;
  for (uint t = gl_LocalInvocationIndex; t < tile; t += gl_WorkGroupSize.x) partial += tileSums.at[t];
  uint before;
  workgroupExclusiveScan(partial, before);
  uint total;
  return before + workgroupExclusiveScan(sum, total);
}

#endif
