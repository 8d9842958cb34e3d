// What points wished for at the end of the last tick: those that go are taken away, and all others are looked at again.
// Leaves to the brush what it moves or takes by itself. Where the wishes are forgotten, only the marks of those that
// were to go are taken off.
#ifndef PALPATE_LIB_RECALL_WISHES_GLSL
#define PALPATE_LIB_RECALL_WISHES_GLSL

#include "shaders/lib/brush_reach.glsl"

void recall(CollectArgs args, UpdateLists update, ResampleLists lists, uint i) {
  const uint id = lists.wishes[i].id;
  const uint slot = slotIn(args.cloud, bucketAt(args.cloud, lists.wishes[i].position), id);
  bool moves = false;
  PointMove move;
  if (slot != kEmptySlot) {
    const vec4 position = args.cloud.positions.at[slot];
    const vec4 normal = args.cloud.normals.at[slot];
    PointMove unused;
    // A build may follow, and then the brush has been at work already.
    moves = subgroupElect() && normal.w != kMarkRefit &&
            !brushedMove(args.cloud, args.tables, slot, position, normal, unused);
    move = stayingMove(args.cloud, slot, position, normal.xyz);
    if (normal.w == kMarkGoes) move.toBucket = kNoBucket;
  }
  const uint at = nextMove(args.update, moves);
  if (moves) writeMove(args.cloud, update, at, move);
}

void forget(CollectArgs args, ResampleLists lists, uint i) {
  const uint slot =
      slotIn(args.cloud, bucketAt(args.cloud, lists.wishes[i].position), lists.wishes[i].id);
  if (slot == kEmptySlot || !subgroupElect()) return;
  if (args.cloud.normals.at[slot].w == kMarkGoes) args.cloud.normals.at[slot].w = 0.0;
}

// From wish `first` on every `stride`-th. One subgroup for each.
void recallWishes(CollectArgs args, UpdateLists update, ResampleLists lists, uint first, uint stride) {
  const uint wishes = min(lists.now.wishes, update.mostMoves);
  for (uint i = first; i < wishes; i += stride) {
    if (args.recalls == kRecallsWishes)
      recall(args, update, lists, i);
    else
      forget(args, lists, i);
  }
}

#endif
