// New points get their ids in the order of the ids that requested them, so that the same edits give the same ids.
#ifndef PALPATE_LIB_BIRTHS_GLSL
#define PALPATE_LIB_BIRTHS_GLSL

#include "shaders/lib/list_moves.glsl"

// The granted requests come as moves, the first of them with the next id that nobody has. From subgroup `first` on every
// `stride`-th.
void bearPoints(UpdateLists update, ResampleLists lists, uint first, uint stride) {
  const uint births = lists.now.births;
  const uint firstNew = args.tables.at[0].firstNew;
  for (uint base = first * gl_SubgroupSize; base < births; base += stride * gl_SubgroupSize) {
    const uint i = base + gl_SubgroupInvocationID;
    const uint id = lists.now.nextId + i;
    const bool comes = i < births && id < args.tables.at[0].ids;
    const uint at = nextMove(args.update, comes);
    if (!comes) continue;
    const uint request = lists.births[i];
    const vec3 place = lists.requests[request].place;
    if (!isNull(args.tables.at[0].colors)) args.tables.at[0].colors.at[id] = lists.requests[request].color;
    args.tables.at[0].parents.at[id - firstNew] = lists.requests[request].parent;
    args.tables.at[0].reaches.at[id - firstNew] = lists.requests[request].reach;
    args.tables.at[0].rests.at[id] = 0.5 * (args.tables.at[0].rests.at[lists.requests[request].id] +
                                            args.tables.at[0].rests.at[lists.requests[request].other]);
    const PointMove move = PointMove(place, id, lists.requests[request].normal, kMarkRefit, kEmptySlot, kNoBucket,
                                     bucketAt(place), 0, kEmptySlot);
    writeMove(update, at, move);
  }
}

#endif
