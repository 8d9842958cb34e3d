#ifndef PALPATE_CHANGED_BUCKETS_GLSL
#define PALPATE_CHANGED_BUCKETS_GLSL
// Marks the buckets in which a point of the drawn cloud was added, removed, moved or rotated, so that the discs around
// them are measured again. The including file declares the push constants as `args`, with `marks`, `changed` and
// `grid`.
#include "shaders/lib/index.glsl"

void markBucketOf(vec4 point) {
  if (args.marks == 0 || floatBitsToUint(point.w) == kEmptySlot) return;
  const uint bucket = bucketOf(args.grid, cellOf(args.grid, point.xyz));
  atomicOr(args.changed.at[bucket / 32], 1u << bucket % 32);
}

#endif
