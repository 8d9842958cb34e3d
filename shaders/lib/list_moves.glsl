// Finds the slots of points and lists their moves, for the passes of an edit. Requires arguments with a cloud, an
// update, capacities and tables.
#ifndef PALPATE_LIB_LIST_MOVES_GLSL
#define PALPATE_LIB_LIST_MOVES_GLSL

#include "shaders/lib/edit_buffers.glsl"
#include "shaders/lib/update_lists.glsl"

// The slot of a point in a bucket; kEmptySlot if it is not there. The whole subgroup calls it together.
uint slotIn(uint bucket, uint id) {
  const uvec2 range = args.cloud.ranges.at[bucket];
  for (uint base = range.x; base < range.y; base += gl_SubgroupSize) {
    const uint slot = base + gl_SubgroupInvocationID;
    const uvec4 found =
        subgroupBallot(slot < range.y && floatBitsToUint(args.cloud.positions.at[min(slot, range.y - 1)].w) == id);
    if (any(notEqual(found, uvec4(0)))) return base + subgroupBallotFindLSB(found);
  }
  return kEmptySlot;
}

UpdateLists updateLists() {
  return UpdateLists(uvec2(args.tables.at[0].moves), uvec2(args.tables.at[0].marks), uvec2(args.tables.at[0].touched),
                     uvec2(args.tables.at[0].movesOf), uvec2(args.capacities), args.tables.at[0].mostMoves);
}

#endif
