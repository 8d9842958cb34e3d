#version 460
#extension GL_GOOGLE_include_directive : require
// Compaction, 4 of 4: marks the back half as ready, or as failed, and ends the noting of buckets.
#include "shaders/lib/index.glsl"
#include "shaders/lib/hash_compaction.glsl"

layout(push_constant, scalar) uniform Push { CompactionArgs args; };

void main() {
  if (threadIndex() != 0) return;
  args.update.at[0].compacting = 0;
  if (!fits(args.state, args.state.at[0].tight, args.from.slots)) {
    if (args.state.at[0].failed == 0) args.state.at[0].failed = kCompactionNoSlots;
    return;
  }
  const uint head = args.state.at[0].head + args.state.at[0].given;
  args.ranges.at[emptyBucket(args.from.grid)] = uvec2(head, args.from.slots);
  args.update.at[0].head = head;
  args.state.at[0].completed = 1;
}
