#version 460
#extension GL_GOOGLE_include_directive : require
// Index update, 1 of 3: every touched bucket gets a run in the list of arrivals, and new slots where it outgrows its
// own. From here on its mark is 1 + its number among the touched.
#include "shaders/lib/index.glsl"
#include "shaders/lib/hash_update.glsl"

layout(push_constant, scalar) uniform Push { HashUpdateArgs args; };

void main() {
  const uint touched = args.update.at[0].touched;
  for (uint t = threadIndex(); t < touched; t += gl_NumWorkGroups.x * gl_WorkGroupSize.x) {
    const uint bucket = args.touched.at[t].bucket;
    const uint arrivals = args.marks.at[bucket] & ~kBucketTouched;
    const uvec2 range = args.cloud.ranges.at[bucket];
    const uint points = range.y - range.x;
    uint first = range.x;
    uint capacity = max(args.capacities.at[bucket], points);
    // Points that leave are not counted, so that this needs no second look: a bucket may grow early, never late.
    const uint most = points + arrivals;
    if (most > capacity) {
      capacity = most + most / 2 + kSpareInBucket;
      first = args.update.at[0].head + atomicAdd(args.update.at[0].wanted, capacity);
      if (first + capacity > args.cloud.slots) atomicOr(args.update.at[0].failed, kUpdateNoSlots);
    }
    if (arrivals > kMostArrivals) atomicOr(args.update.at[0].failed, kUpdateCrowded);
    args.touched.at[t].firstArrival = arrivals == 0 ? 0 : atomicAdd(args.update.at[0].arrivals, arrivals);
    args.touched.at[t].arrivals = arrivals;
    args.touched.at[t].placed = 0;
    args.touched.at[t].firstSlot = first;
    args.touched.at[t].capacity = capacity;
    args.marks.at[bucket] = t + 1;
  }
}
