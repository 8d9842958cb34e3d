// New points get their ids in the order of the ids that requested them, so that the same edits give the same ids.
#ifndef PALPATE_LIB_BIRTHS_GLSL
#define PALPATE_LIB_BIRTHS_GLSL

#include "shaders/lib/list_moves.glsl"

uint birthsOf(ResampleLists lists) { return lists.now.births; }

// The found state of a new point: half way between those of its ends if one stroke has found both, else that of the
// later stroke.
void noteBirth(uint id, uint one, uint other) {
  const Found a = args.tables.at[0].founds.at[one], b = args.tables.at[0].founds.at[other];
  Found found = a;
  if (a.stroke < b.stroke) found = b;
  if (a.stroke == b.stroke) {
    const vec3 sum = a.normal + b.normal;
    const float size = length(sum);
    found.position = 0.5 * (a.position + b.position);
    if (size > 1e-3) found.normal = sum / size;
    found.room = middleRoom(a.room, b.room);
  }
  args.tables.at[0].founds.at[id] = found;
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
  noteBirth(id, lists.requests[request].id, lists.requests[request].other);
  move = PointMove(place, id, lists.requests[request].normal, kMarkRefit, kEmptySlot, kNoBucket, bucketAt(place), 0,
                   kEmptySlot);
  return true;
}

#endif
