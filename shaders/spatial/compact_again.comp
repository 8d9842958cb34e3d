#version 460
#extension GL_GOOGLE_include_directive : require
// Compaction, 3 of 4: copies every noted bucket again, in its order: over its first copy if it fits there, else into
// new slots. One subgroup for each. Does nothing if not all of them fit.
#include "shaders/lib/index.glsl"
#include "shaders/lib/hash_compaction.glsl"

layout(push_constant, scalar) uniform Push { CompactionArgs args; };

void leaveEmpty(uint from, uint to) {
  for (uint slot = from + gl_SubgroupInvocationID; slot < to; slot += gl_SubgroupSize)
    args.positions.at[slot].w = uintBitsToFloat(kEmptySlot);
}

void main() {
  const bool roomy = fits(args.state, args.state.at[0].loose, args.from.slots);
  if (!roomy && !fits(args.state, args.state.at[0].tight, args.from.slots)) return;
  const uint list = dirtyListFrom(args.from.grid);
  const uint noted = args.update.at[0].dirty;
  const uint stride = gl_NumWorkGroups.x * gl_NumSubgroups;
  for (uint i = workgroupIndex() * gl_NumSubgroups + gl_SubgroupID; i < noted; i += stride) {
    const uint bucket = args.dirty.words[list + i];
    const uvec2 now = args.from.ranges.at[bucket];
    const uvec2 copied = args.ranges.at[bucket];
    const uint points = now.y - now.x;
    uint first = copied.x;
    uint capacity = copied.y - copied.x;
    if (points > capacity) {
      leaveEmpty(copied.x, copied.y);
      capacity = roomy ? roomToGrow(points) : points;
      uint before = 0;
      if (subgroupElect()) before = atomicAdd(args.state.at[0].given, capacity);
      first = args.state.at[0].head + subgroupBroadcastFirst(before);
    } else {
      leaveEmpty(first + points, copied.y);
    }
    for (uint k = gl_SubgroupInvocationID; k < points; k += gl_SubgroupSize) {
      args.positions.at[first + k] = args.from.positions.at[now.x + k];
      args.normals.at[first + k] = args.from.normals.at[now.x + k];
    }
    if (subgroupElect()) {
      args.ranges.at[bucket] = uvec2(first, first + points);
      args.capacities.at[bucket] = capacity;
    }
  }
}
