// Carries out what points requested at the end of the last tick: points marked for removal are removed, and all others
// are examined again. Points that the brush itself moves or removes are left to it. If the requests are dropped, only
// the marks for removal are cleared.
#ifndef PALPATE_LIB_RECALL_REQUESTS_GLSL
#define PALPATE_LIB_RECALL_REQUESTS_GLSL

#include "shaders/lib/brush_reach.glsl"

uint requestsOf(UpdateLists update, ResampleLists lists) { return min(lists.now.requests, update.mostMoves); }

// The slot of the point that made request `i`; kEmptySlot if it is no longer there. One subgroup for each.
uint requestingSlot(ResampleLists lists, uint i) {
  return slotIn(bucketAt(lists.requests[i].position), lists.requests[i].id);
}

// `brushed`: the brush does something to it in this tick.
bool recalled(uint slot, vec4 position, vec4 normal, bool brushed, out PointMove move) {
  move = stayingMove(slot, position, normal.xyz);
  if (normal.w == kMarkGoes) move.toBucket = kNoBucket;
  // A full build may follow, and then the brush has already been applied.
  return subgroupElect() && normal.w != kMarkRefit && !brushed;
}

// From request `first` on every `stride`-th. One subgroup for each.
void forgetRequests(UpdateLists update, ResampleLists lists, uint first, uint stride) {
  const uint requests = requestsOf(update, lists);
  for (uint i = first; i < requests; i += stride) {
    const uint slot = requestingSlot(lists, i);
    if (slot == kEmptySlot || !subgroupElect()) continue;
    if (args.cloud.normals.at[slot].w == kMarkGoes) args.cloud.normals.at[slot].w = 0.0;
  }
}

#endif
