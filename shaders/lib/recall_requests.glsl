// Carries out what points requested at the end of the last tick: those that go are taken away, and all others are
// examined again. Leaves to the brush what it moves or takes by itself. Where the requests are forgotten, only the marks
// of those that were to go are taken off.
#ifndef PALPATE_LIB_RECALL_REQUESTS_GLSL
#define PALPATE_LIB_RECALL_REQUESTS_GLSL

#include "shaders/lib/brush_reach.glsl"

void recall(UpdateLists update, ResampleLists lists, uint i) {
  const uint id = lists.requests[i].id;
  const uint slot = slotIn(bucketAt(lists.requests[i].position), id);
  bool moves = false;
  PointMove move;
  if (slot != kEmptySlot) {
    const vec4 position = args.cloud.positions.at[slot];
    const vec4 normal = args.cloud.normals.at[slot];
    PointMove unused;
    // A build may follow, and then the brush has been at work already.
    moves = subgroupElect() && normal.w != kMarkRefit &&
            !brushedMove(slot, position, normal, unused);
    move = stayingMove(slot, position, normal.xyz);
    if (normal.w == kMarkGoes) move.toBucket = kNoBucket;
  }
  const uint at = nextMove(args.update, moves);
  if (moves) writeMove(update, at, move);
}

void forget(ResampleLists lists, uint i) {
  const uint slot =
      slotIn(bucketAt(lists.requests[i].position), lists.requests[i].id);
  if (slot == kEmptySlot || !subgroupElect()) return;
  if (args.cloud.normals.at[slot].w == kMarkGoes) args.cloud.normals.at[slot].w = 0.0;
}

// From request `first` on every `stride`-th. One subgroup for each.
void recallRequests(UpdateLists update, ResampleLists lists, uint first, uint stride) {
  const uint requests = min(lists.now.requests, update.mostMoves);
  for (uint i = first; i < requests; i += stride) {
    if (args.recalls == kRecallsRequests)
      recall(update, lists, i);
    else
      forget(lists, i);
  }
}

#endif
