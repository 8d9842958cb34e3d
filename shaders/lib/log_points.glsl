// Writes the present state of points to the edit log: entries are in the order of the lists from the head on; the head
// is moved when all are written.
#ifndef PALPATE_LIB_LOG_POINTS_GLSL
#define PALPATE_LIB_LOG_POINTS_GLSL

#include "shaders/lib/edit_buffers.glsl"

void logPoint(uint entry, vec3 position, uint id, vec3 normal, uint color, uint parent) {
  const uint slot = entry & args.capacityMask;
  args.entries.at[slot].position = position;
  args.entries.at[slot].id = id;
  args.entries.at[slot].normal = normal;
  args.entries.at[slot].color = color;
  args.entries.at[slot].parent = parent;
}

// Points that are removed no longer have a slot: the moves hold them, and their number among the removed ones.
void logGone(uint entry) {
  const uint moves = args.update.at[0].moves;
  if (args.update.at[0].gone == 0) return;
  PointMoves list = args.tables.at[0].moves;
  for (uint i = threadIndex(); i < moves; i += gl_NumWorkGroups.x * gl_WorkGroupSize.x) {
    if (list.at[i].toBucket != kNoBucket) continue;
    const uint id = list.at[i].id;
    logPoint(entry + list.at[i].room, list.at[i].position, id | kPointGone, list.at[i].normal,
             colorOf(args.tables, id), parentOf(args.tables, id));
  }
}

#endif
