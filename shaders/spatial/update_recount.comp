#version 460
#extension GL_GOOGLE_include_directive : require
// After a full build: lists the slots whose points changed, if a list is given, and finds where the empty slots begin.
// A compaction in progress is abandoned.
#extension GL_EXT_buffer_reference_uvec2 : require
#include "shaders/lib/index.glsl"
#include "shaders/lib/hash_update.glsl"

layout(push_constant, scalar) uniform Push { HashRecountArgs args; };

void main() {
  const uint slot = threadIndex();
  const bool lists = uvec2(args.changed) != uvec2(0);
  const bool changed = lists && slot < args.cloud.slots && args.cloud.normals.at[slot].w != 0.0 &&
                       floatBitsToUint(args.cloud.positions.at[slot].w) != kEmptySlot;
  const uint at = nextChanged(args.update, changed);
  if (changed) args.changed.at[at] = slot;
  if (slot != 0) return;
  const uvec2 empty = args.cloud.ranges.at[emptyBucket(args.cloud.grid)];
  const uint points = args.cloud.slots - (empty.y - empty.x);
  args.update.at[0].head = points;
  args.update.at[0].points = points;
  args.update.at[0].compacting = 0;
}
