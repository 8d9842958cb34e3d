#ifndef PALPATE_CHANGED_BUCKETS_GLSL
#define PALPATE_CHANGED_BUCKETS_GLSL
// The buckets in which a point of the drawn cloud has come, gone, moved or turned, for whoever measures the discs about
// them again. The including file declares the push constants as `args`, with `marks`, `changed` and `grid`.
#include "shaders/lib/index.glsl"

void markBucketOf(vec4 point) {
  if (args.marks == 0 || floatBitsToUint(point.w) == kEmptySlot) return;
  const uint bucket = bucketOf(args.grid, cellOf(args.grid, point.xyz));
  atomicOr(args.changed.at[bucket / 32], 1u << bucket % 32);
}

#endif
