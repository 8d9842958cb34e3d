#version 460
#extension GL_GOOGLE_include_directive : require
// Applies the moves before a full build: each is written to the slot of its point, and new points into the empty slots
// at the end. Clears the marks of their buckets; if the list is incomplete, it does only that.
#include "shaders/lib/index.glsl"
#include "shaders/lib/hash_update.glsl"

layout(push_constant, scalar) uniform Push { HashUpdateArgs args; };

void main() {
  const bool failed = (args.update.at[0].failed & (kUpdateUnknown | kUpdateTooLarge)) != 0;
  const uint moves = min(args.update.at[0].moves, args.mostMoves);
  for (uint i = threadIndex(); i < moves; i += gl_NumWorkGroups.x * gl_WorkGroupSize.x) {
    const uint from = args.moves.at[i].fromBucket;
    const uint to = args.moves.at[i].toBucket;
    uint slot = args.moves.at[i].slot;
    if (from != kNoBucket) args.marks.at[from] = 0;
    if (to != kNoBucket) args.marks.at[to] = 0;
    if (failed) continue;
    if (from == kNoBucket) {
      slot = args.update.at[0].head + atomicAdd(args.update.at[0].wanted, 1);
      if (slot >= args.cloud.slots) {
        atomicOr(args.update.at[0].failed, kUpdateNoSlots);
        continue;
      }
    }
    if (to == kNoBucket) {
      args.cloud.positions.at[slot].w = uintBitsToFloat(kEmptySlot);
      args.moves.at[i].room = atomicAdd(args.update.at[0].gone, 1);
    } else {
      args.cloud.positions.at[slot] = vec4(args.moves.at[i].position, uintBitsToFloat(args.moves.at[i].id));
      args.cloud.normals.at[slot] = vec4(args.moves.at[i].normal, args.moves.at[i].mark);
    }
  }
}
