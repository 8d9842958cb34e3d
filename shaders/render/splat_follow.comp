#version 460
#extension GL_GOOGLE_include_directive : require
// Catching up with the edit log, before its last pass: lists how each point's last entry changes the index of the
// drawn points, and the cells that it changes.
#include "shaders/lib/index.glsl"
#include "shaders/render/cell_lists.glsl"
#include "shaders/render/changed_point.glsl"
#include "shaders/shared/splat_radius.h"

layout(push_constant, scalar) uniform Push { SplatFollowArgs args; };
#include "shaders/lib/update_lists.glsl"

// Addresses as plain words: see UpdateLists.
UpdateLists updateLists() {
  return UpdateLists(uvec2(args.lists.at[0].moves), uvec2(args.lists.at[0].marks), uvec2(args.lists.at[0].touched),
                     uvec2(args.lists.at[0].movesOf), uvec2(args.lists.at[0].capacities), args.lists.at[0].mostMoves);
}

// The slot of a point in its bucket, which is in the order of the ids.
uint slotOf(uint bucket, uint id) {
  const uvec2 range = args.cloud.ranges.at[bucket];
  uint low = range.x, high = range.y;
  while (low < high) {
    const uint middle = (low + high) / 2;
    if (floatBitsToUint(args.cloud.positions.at[middle].w) < id)
      low = middle + 1;
    else
      high = middle;
  }
  const bool found = low < range.y && floatBitsToUint(args.cloud.positions.at[low].w) == id;
  if (!found) atomicOr(args.update.at[0].failed, kUpdateUnknown);
  return found ? low : kEmptySlot;
}

// The whole subgroup calls it together.
void listCell(bool changes, ivec3 cell) {
  const uvec4 ballot = subgroupBallot(changes);
  const uint count = subgroupBallotBitCount(ballot);
  if (count == 0) return;
  CellLists cells = args.lists.at[0].cells;
  uint first = 0;
  if (subgroupElect()) first = atomicAdd(cells.about.count, count);
  first = subgroupBroadcastFirst(first);
  if (!changes) return;
  const uint at = first + subgroupBallotExclusiveBitCount(ballot);
  const uint bucket = bucketOf(args.cloud.grid, cell);
  const uvec2 range = args.cloud.ranges.at[bucket];
  const bool fits = at < args.lists.at[0].mostCells;
  if (fits) cells.at[at] = cell;
  const bool crowded = range.y - range.x > splatMostInBucket(gl_SubgroupSize);
  if (!fits || crowded || any(greaterThan(abs(cell), ivec3(kSplatFarCell)))) cells.about.everywhere = 1;
  atomicMax(args.lists.at[0].lastOf.at[bucket], args.listedBefore + at + 1);
}

void main() {
  const uint i = threadIndex();
  bool isLast = false, wasThere = false, stays = false;
  PointMove move;
  move.position = vec3(0);
  vec3 before = vec3(0);
  if (i < args.entryCount) {
    // Field by field, as in drawn_cloud_apply.comp.
    const uint slot = (args.firstSlot + i) & args.slotMask;
    const uint state = args.entries.at[slot].id;
    move.id = state & ~kPointGone;
    isLast = move.id < args.pointCount && args.latest.at[move.id] == i + 1;
    stays = isLast && (state & kPointGone) == 0;
    move.position = args.entries.at[slot].position;
    move.normal = args.entries.at[slot].normal;
  }
  bool changes = false;
  if (isLast) {
    const vec4 point = args.positions.at[move.id];
    before = point.xyz;
    wasThere = floatBitsToUint(point.w) != kEmptySlot;
    changes = changesDiscs(point, args.normals.at[move.id].xyz, stays, move.position, move.normal);
  }
  wasThere = wasThere && changes;
  stays = stays && changes;
  const ivec3 from = cellOf(args.cloud.grid, before), to = cellOf(args.cloud.grid, move.position);
  listCell(wasThere, from);
  listCell(stays && !(wasThere && from == to), to);
  const uint at = nextMove(args.update, changes);
  if (!changes) return;
  move.mark = 0;
  move.before = 0;
  move.room = kEmptySlot;
  move.fromBucket = wasThere ? bucketOf(args.cloud.grid, from) : kNoBucket;
  move.toBucket = stays ? bucketOf(args.cloud.grid, to) : kNoBucket;
  move.slot = wasThere ? slotOf(move.fromBucket, move.id) : kEmptySlot;
  writeMove(updateLists(), at, move);
}
