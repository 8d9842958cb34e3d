// The points of a bucket, for one invocation that visits a neighbourhood alone, within its work budget.
#ifndef PALPATE_LIB_BUCKET_SHARE_GLSL
#define PALPATE_LIB_BUCKET_SHARE_GLSL

#include "shaders/lib/contact_buffers.glsl"

// Which points are visited: the one numbered `own` of every `sharers`.
struct Share {
  uint own, sharers;
};

// The points of a bucket that are still visited. `work`: iterations so far; visits end at `budget`.
uvec2 bucketWithin(ivec3 cell, Share share, uint budget, inout uint work) {
  const uvec2 range = args.cloud.ranges.at[bucketOf(args.cloud.grid, cell)];
  const uint rounds = min((range.y - range.x + share.sharers - 1) / share.sharers, budget - min(work, budget));
  work += 1 + rounds;
  return uvec2(range.x + share.own, min(range.y, range.x + rounds * share.sharers));
}

#endif
