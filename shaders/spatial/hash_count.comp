#version 460
#extension GL_GOOGLE_include_directive : require
// The bucket of every point, and the point's rank in it in the order of arrival. Neighbours in memory mostly share a
// bucket, since the points are in the order of the last build: each run of equal buckets in a subgroup is counted with
// one atomic.
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_shuffle : require
#include "shaders/shared/spatial_hash.h"
#include "shaders/lib/index.glsl"

layout(push_constant, scalar) uniform Push { HashCountArgs args; };

void main() {
  const uint i = threadIndex();
  if (i >= args.count) return;
  const uint key = bucketOfSlot(args.grid, args.positions.at[i]);
  const uint lane = gl_SubgroupInvocationID;
  const uint before = subgroupShuffle(key, max(lane, 1) - 1);
  const uvec4 heads = subgroupBallot(lane == 0 || before != key);
  const uint head = subgroupBallotFindMSB(heads & gl_SubgroupLeMask);
  // The run ends before the next head, or with the subgroup's last point.
  const uvec4 later = heads & gl_SubgroupGtMask;
  const uint points = subgroupBallotBitCount(subgroupBallot(true));
  const uint end = any(notEqual(later, uvec4(0))) ? subgroupBallotFindLSB(later) : points;
  uint first = 0;
  if (lane == head) first = atomicAdd(args.counts.at[key], end - head);
  args.keys.at[i] = key;
  args.arrivals.at[i] = subgroupShuffle(first, head) + lane - head;
}
