#version 460
#extension GL_GOOGLE_include_directive : require
// Brings the points into the order of their buckets and, within a bucket, keeps their previous order: a point's rank is
// the number of points of its bucket before it. Neighbouring invocations rank against the same bucket, so its indices
// come from cache.
#include "shaders/lib/index.glsl"
#include "shaders/shared/spatial_hash.h"

layout(push_constant, scalar) uniform Push { HashSettleArgs args; };

void main() {
  const uint place = threadIndex();
  if (place >= args.count) return;
  const uint from = args.order.at[place];
  const uint key = args.keys.at[from];
  const uvec2 range = args.ranges.at[key];
  const uint points = range.y - range.x;
  uint to = place;
  const bool empty = key == args.emptyBucket;  // empty slots are in any order
  if (points <= kMaxRanked && !empty) {
    to = range.x;
    for (uint other = range.x; other < range.y; ++other) to += args.order.at[other] < from ? 1 : 0;
  }
  if (points > kCrowdedBucket && !empty && place == range.x) args.crowded.at[0] = points;
  args.positionsOut.at[to] = args.positionsIn.at[from];
  args.normalsOut.at[to] = args.normalsIn.at[from];
}
