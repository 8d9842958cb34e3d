// New points get their ids, in the order of the ids that wished for them, so that the same edits give the same ids.
#ifndef PALPATE_LIB_BIRTHS_GLSL
#define PALPATE_LIB_BIRTHS_GLSL

#include "shaders/lib/edit_buffers.glsl"

shared uint wishers[kMostBirths];

// One workgroup.
void bearPoints(CollectArgs args, ResampleLists lists) {
  const uint wished = lists.now.births;
  const uint births = wished > kMostBirths ? 0 : wished;
  const uint next = lists.now.nextId;
  for (uint i = gl_LocalInvocationIndex; i < births; i += gl_WorkGroupSize.x)
    wishers[i] = lists.wishes[lists.births[i]].id;
  barrier();
  const uint firstNew = args.tables.at[0].firstNew;
  for (uint base = 0; base < births; base += gl_WorkGroupSize.x) {
    const uint i = base + gl_LocalInvocationIndex;
    bool comes = i < births;
    uint id = next;
    if (comes) {
      const uint wisher = wishers[i];
      for (uint other = 0; other < births; ++other) id += wishers[other] < wisher ? 1 : 0;
      comes = id < args.tables.at[0].ids;
    }
    const uint at = nextMove(args.update, comes);
    if (comes) {
      const uint wish = lists.births[i];
      const vec3 place = lists.wishes[wish].place;
      if (!isNull(args.tables.at[0].colors)) args.tables.at[0].colors.at[id] = lists.wishes[wish].color;
      args.tables.at[0].parents.at[id - firstNew] = lists.wishes[wish].parent;
      const PointMove move = PointMove(place, id, lists.wishes[wish].normal, kMarkRefit, kEmptySlot, kNoBucket,
                                       bucketAt(args.cloud, place));
      writeMove(args.update, args.moves, args.marks, args.touched, args.tables.at[0].mostMoves, at, move);
    }
  }
  barrier();
  if (gl_LocalInvocationIndex != 0) return;
  lists.now.nextId = min(next + births, args.tables.at[0].ids);
  lists.now.tick += 1;
  const uint thinning = lists.now.thinning;
  lists.now.thinning = wished > kMostBirths ? min(thinning + 1, 15) : thinning - min(thinning, 1);
}

#endif
