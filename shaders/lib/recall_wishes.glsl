// What points wished for at the end of the last tick: those that go are taken away, a new point comes where no wish of
// a smaller id stands in its way, and all others are looked at again. Leaves to the brush what it moves or takes by
// itself. Where the wishes are dropped, only the marks of those that were to go are taken off.
#ifndef PALPATE_LIB_RECALL_WISHES_GLSL
#define PALPATE_LIB_RECALL_WISHES_GLSL

#include "shaders/lib/brush_reach.glsl"
#include "shaders/lib/claims.glsl"

// Whether a wish has its own cell of the claims, and none of a smaller id in the cells about it a place too near.
bool claimStands(ResampleLists lists, HashGrid grid, vec3 place, uint id) {
  const uint kCellsAbout = 27;
  const float clearance = kLeastClearance * brush.support / kSupportSpacings;
  const ivec3 cell = cellOf(grid, place);
  bool stands = lists.claims[bucketOf(grid, cell)] == id;
  for (uint c = gl_SubgroupInvocationID; c < kCellsAbout; c += gl_SubgroupSize) {
    const ivec3 about = cell + ivec3(c % 3, c / 3 % 3, c / 9) - 1;
    const uint claim = bucketOf(grid, about);
    if (lists.claims[claim] < id && distance(lists.claimed[claim], place) < clearance) stands = false;
  }
  return subgroupAll(stands);
}

// Another part of the points in each tick.
bool isHeard(ResampleLists lists, uint id) {
  const uint scattered = (id ^ lists.now.tick * 19349663u) * 2654435761u;
  return scattered >> 16 << lists.now.thinning < 65536u;
}

void recall(CollectArgs args, ResampleLists lists, uint mostMoves, uint i) {
  const uint id = lists.wishes[i].id;
  const uint slot = slotIn(args.cloud, bucketAt(args.cloud, lists.wishes[i].position), id);
  bool moves = false;
  PointMove move;
  if (slot != kEmptySlot) {
    const vec4 position = args.cloud.positions.at[slot];
    const vec4 normal = args.cloud.normals.at[slot];
    PointMove unused;
    // A build may follow, and then the brush has been at work already.
    moves = subgroupElect() && normal.w != kMarkRefit && !brushedMove(args.cloud, args.tables, slot, position, unused);
    move = stayingMove(args.cloud, slot, position, normal.xyz);
    if (normal.w == kMarkGoes) move.toBucket = kNoBucket;
  }
  const uint at = nextMove(args.update, moves);
  if (moves) writeMove(args.update, args.moves, args.marks, args.touched, mostMoves, at, move);
  const bool inserts = lists.wishes[i].inserts != 0 && isHeard(lists, id) &&
                       claimStands(lists, claimsFor(brush.support), lists.wishes[i].place, id);
  if (inserts && subgroupElect()) {
    const uint birth = atomicAdd(lists.now.births, 1);
    if (birth < kMostBirths) lists.births[birth] = i;
  }
}

void forget(CollectArgs args, ResampleLists lists, uint i) {
  const uint slot =
      slotIn(args.cloud, bucketAt(args.cloud, lists.wishes[i].position), lists.wishes[i].id);
  if (slot == kEmptySlot || !subgroupElect()) return;
  if (args.cloud.normals.at[slot].w == kMarkGoes) args.cloud.normals.at[slot].w = 0.0;
}

// From wish `first` on every `stride`-th. One subgroup for each.
void recallWishes(CollectArgs args, ResampleLists lists, uint first, uint stride) {
  const uint mostMoves = args.tables.at[0].mostMoves;
  const uint wishes = min(lists.now.wishes, mostMoves);
  for (uint i = first; i < wishes; i += stride) {
    if (args.recalls == kRecallsWishes)
      recall(args, lists, mostMoves, i);
    else
      forget(args, lists, i);
  }
}

#endif
