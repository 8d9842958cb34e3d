// New points get their ids in the order of the ids that wished for them, so that the same edits give the same ids.
#ifndef PALPATE_LIB_BIRTHS_GLSL
#define PALPATE_LIB_BIRTHS_GLSL

#include "shaders/lib/edit_buffers.glsl"

// The granted wishes come as moves, the first of them with the next id that nobody has. From subgroup `first` on every
// `stride`-th.
void bearPoints(CollectArgs args, UpdateLists update, ResampleLists lists, uint first, uint stride) {
  const uint births = lists.now.births;
  const uint firstNew = args.tables.at[0].firstNew;
  for (uint base = first * gl_SubgroupSize; base < births; base += stride * gl_SubgroupSize) {
    const uint i = base + gl_SubgroupInvocationID;
    const uint id = lists.now.nextId + i;
    const bool comes = i < births && id < args.tables.at[0].ids;
    const uint at = nextMove(args.update, comes);
    if (!comes) continue;
    const uint wish = lists.births[i];
    const vec3 place = lists.wishes[wish].place;
    if (!isNull(args.tables.at[0].colors)) args.tables.at[0].colors.at[id] = lists.wishes[wish].color;
    args.tables.at[0].parents.at[id - firstNew] = lists.wishes[wish].parent;
    args.tables.at[0].reaches.at[id - firstNew] = lists.wishes[wish].reach;
    args.tables.at[0].rests.at[id] =
        0.5 * (args.tables.at[0].rests.at[lists.wishes[wish].id] + args.tables.at[0].rests.at[lists.wishes[wish].other]);
    const PointMove move =
        PointMove(place, id, lists.wishes[wish].normal, kMarkRefit, kEmptySlot, kNoBucket,
                                     bucketAt(args.cloud, place), 0, kEmptySlot);
    writeMove(args.cloud, update, at, move);
  }
}

#endif
