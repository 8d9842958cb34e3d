// The points of a bucket for one invocation that looks at a neighbourhood by itself, as far as its work goes.
#ifndef PALPATE_LIB_BUCKET_SHARE_GLSL
#define PALPATE_LIB_BUCKET_SHARE_GLSL

#include "shaders/lib/contact_buffers.glsl"

// Which points are looked at: of every `sharers` the one numbered `own`.
struct Share {
  uint own, sharers;
};

// The points of a bucket that are still looked at. `work`: rounds so far; none are left at `budget`.
uvec2 bucketWithin(CloudView cloud, ivec3 cell, Share share, uint budget, inout uint work) {
  const uvec2 range = cloud.ranges.at[bucketOf(cloud.grid, cell)];
  const uint rounds = min((range.y - range.x + share.sharers - 1) / share.sharers, budget - min(work, budget));
  work += 1 + rounds;
  return uvec2(range.x + share.own, min(range.y, range.x + rounds * share.sharers));
}

#endif
