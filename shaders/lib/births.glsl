// New points get their ids in the order of the ids that requested them, so that the same edits give the same ids.
#ifndef PALPATE_LIB_BIRTHS_GLSL
#define PALPATE_LIB_BIRTHS_GLSL

#include "shaders/lib/list_moves.glsl"

uint birthsOf(ResampleLists lists) { return lists.now.births; }

// The state in which the last stroke that moved any of its ends would have found a new point.
void noteBirth(ResampleLists lists, uint request, uint id) {
  const Found a = args.tables.at[0].founds.at[lists.requests[request].id];
  const Found b = args.tables.at[0].founds.at[lists.requests[request].other];
  const uint last = max(a.stroke, b.stroke);
  const float room = middleRoom(a.stroke == last ? a.room : kUnseen, b.stroke == last ? b.room : kUnseen);
  args.tables.at[0].founds.at[id] =
      Found(lists.requests[request].found, last, lists.requests[request].foundNormal, room);
}

// The granted requests become moves; the first gets the next unused id. False if the i-th request does not exist, or no
// id is left for it.
bool isBorn(ResampleLists lists, uint i, out PointMove move) {
  const uint id = lists.now.nextId + i;
  if (i >= lists.now.births || id >= args.tables.at[0].ids) return false;
  const uint firstNew = args.tables.at[0].firstNew;
  const uint request = lists.births[i];
  const vec3 place = lists.requests[request].place;
  if (!isNull(args.tables.at[0].colors)) args.tables.at[0].colors.at[id] = lists.requests[request].color;
  args.tables.at[0].parents.at[id - firstNew] = lists.requests[request].parent;
  args.tables.at[0].reaches.at[id - firstNew] = lists.requests[request].reach;
  args.tables.at[0].rests.at[id] = 0.5 * (args.tables.at[0].rests.at[lists.requests[request].id] +
                                          args.tables.at[0].rests.at[lists.requests[request].other]);
  noteBirth(lists, request, id);
  // Beside a locked point it is part of a cliff, and is held.
  if (isLocked(args.tables, lists.requests[request].id) || isLocked(args.tables, lists.requests[request].other))
    atomicOr(args.tables.at[0].locked.at[id / 32], 1u << id % 32);
  move = PointMove(place, id, lists.requests[request].normal, kMarkRefit, kEmptySlot, kNoBucket, bucketAt(place), 0,
                   kEmptySlot);
  return true;
}

#endif
