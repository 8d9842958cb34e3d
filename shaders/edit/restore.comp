#version 460
#extension GL_GOOGLE_include_directive : require
// Changes that the host gives, as moves: each point is looked for where its change says that it stands. One subgroup
// for each change.
#include "shaders/lib/index.glsl"
#include "shaders/lib/edit_buffers.glsl"

layout(push_constant, scalar) uniform Push { RestoreArgs args; };

uint bucketAt(vec3 position) { return bucketOf(args.cloud.grid, cellOf(args.cloud.grid, position)); }

// The slot where a bucket has the point; kEmptySlot when it has not.
uint slotOf(uint bucket, uint id) {
  const uvec2 range = args.cloud.ranges.at[bucket];
  for (uint base = range.x; base < range.y; base += gl_SubgroupSize) {
    const uint slot = base + gl_SubgroupInvocationID;
    const uvec4 found =
        subgroupBallot(slot < range.y && floatBitsToUint(args.cloud.positions.at[min(slot, range.y - 1)].w) == id);
    if (any(notEqual(found, uvec4(0)))) return base + subgroupBallotFindLSB(found);
  }
  return kEmptySlot;
}

void main() {
  const uint i = workgroupIndex() * gl_NumSubgroups + gl_SubgroupID;
  if (i >= args.count) return;
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
  if ((fromId & kPointGone) == 0) {
    move.fromBucket = bucketAt(args.changes.at[i].from.position);
    move.slot = slotOf(move.fromBucket, id);
    if (move.slot == kEmptySlot) {
      if (subgroupElect()) atomicOr(args.update.at[0].failed, kUpdateUnknown);
      return;
    }
  }
  const bool writes = subgroupElect() && (move.fromBucket != kNoBucket || move.toBucket != kNoBucket);
  const uint at = nextMove(args.update, writes);
  if (!writes) return;
  if (!isNull(args.colors)) args.colors.at[id] = args.changes.at[i].to.color;
  if (id >= args.firstNew) args.parents.at[id - args.firstNew] = args.changes.at[i].to.parent;
  writeMove(args.update, args.moves, args.marks, args.touched, args.mostMoves, at, move);
}
