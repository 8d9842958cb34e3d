#version 460
#extension GL_GOOGLE_include_directive : require
// Turns changes given by the host into moves: each point is searched at the position in its change. One subgroup for
// each change.
#include "shaders/lib/index.glsl"
#include "shaders/lib/edit_buffers.glsl"

layout(push_constant, scalar) uniform Push { RestoreArgs args; };
#include "shaders/lib/list_moves.glsl"

// Data of a point besides position and normal. After the update has been carried out.
void finish(uint i) {
  if (args.update.at[0].failed != 0 || !subgroupElect()) return;
  if (args.changes.at[i].from.id == kChangeLeftOut) return;
  const uint id = args.changes.at[i].to.id & ~kPointGone;
  atomicMax(args.lists.now.nextId, id + 1);
  if (!isNull(args.tables.at[0].colors)) args.tables.at[0].colors.at[id] = args.changes.at[i].to.color;
  args.tables.at[0].founds.at[id].stroke = 0;
  const uint firstNew = args.tables.at[0].firstNew;
  if (id < firstNew) return;
  args.tables.at[0].parents.at[id - firstNew] = args.changes.at[i].to.parent;
  // A point that no edit here has created has its rest position where it is given first.
  if (floatBitsToUint(args.tables.at[0].rests.at[id].x) == kNeverRested)
    args.tables.at[0].rests.at[id] = args.changes.at[i].to.position;
}

void main() {
  const uint i = workgroupIndex() * gl_NumSubgroups + gl_SubgroupID;
  if (i >= args.count) return;
  if ((args.flags & kRestoreFinishes) != 0) {
    finish(i);
    return;
  }
  const uint fromId = args.changes.at[i].from.id;
  const uint toId = args.changes.at[i].to.id;
  const uint id = toId & ~kPointGone;
  PointMove move;
  move.position = args.changes.at[i].to.position;
  move.id = id;
  move.normal = args.changes.at[i].to.normal;
  move.mark = kMarkGiven;
  move.slot = kEmptySlot;
  move.fromBucket = kNoBucket;
  move.toBucket = (toId & kPointGone) != 0 ? kNoBucket : bucketAt(move.position);
  move.before = 0;
  move.room = kEmptySlot;
  if ((fromId & kPointGone) == 0) {
    move.fromBucket = bucketAt(args.changes.at[i].from.position);
    move.slot = slotIn(move.fromBucket, id);
    if (move.slot == kEmptySlot) {
      if (!subgroupElect()) return;
      if ((args.flags & kRestoreOffered) != 0)
        args.changes.at[i].from.id = kChangeLeftOut;
      else
        atomicOr(args.update.at[0].failed, kUpdateUnknown);
      return;
    }
  }
  const bool writes = subgroupElect() && (move.fromBucket != kNoBucket || move.toBucket != kNoBucket);
  const uint at = nextMove(args.update, writes);
  if (!writes) return;
  writeMove(updateLists(), at, move);
}
