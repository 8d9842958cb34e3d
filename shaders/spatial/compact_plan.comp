#version 460
#extension GL_GOOGLE_include_directive : require
// Compaction, 2 of 4: counts slots for the buckets that changed while they were copied and outgrew their first copy.
#include "shaders/lib/index.glsl"
#include "shaders/lib/hash_compaction.glsl"

layout(push_constant, scalar) uniform Push { CompactionArgs args; };

void main() {
  const uint noted = args.update.at[0].dirty;
  if (noted > args.dirty.capacity) {
    if (threadIndex() == 0) atomicOr(args.state.at[0].failed, kCompactionTooDirty);
    return;
  }
  if (threadIndex() == 0) {  // one by one: validation on the GPU counts the whole vector as four words
    args.state.at[0].againGroups.x = updateGroups(noted, gl_NumSubgroups);
    args.state.at[0].againGroups.y = 1;
    args.state.at[0].againGroups.z = 1;
  }
  const uint list = dirtyListFrom(args.from.grid);
  const uint stride = gl_NumWorkGroups.x * gl_WorkGroupSize.x;
  for (uint i = threadIndex(); i < noted; i += stride) {
    const uint bucket = args.dirty.words[list + i];
    const uvec2 now = args.from.ranges.at[bucket];
    const uvec2 copied = args.ranges.at[bucket];
    const uint points = now.y - now.x;
    if (points <= copied.y - copied.x) continue;
    atomicAdd(args.state.at[0].loose, roomToGrow(points));
    atomicAdd(args.state.at[0].tight, points);
  }
}
