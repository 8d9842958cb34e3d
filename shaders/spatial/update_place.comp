#version 460
#extension GL_GOOGLE_include_directive : require
// Index update, 2 of 3: points that stay in their bucket are written in their slot; those that leave it leave the slot
// empty and, unless they are taken away, stand in the arrivals of another. Does nothing when the plan did not come out.
#include "shaders/lib/index.glsl"
#include "shaders/lib/hash_update.glsl"

layout(push_constant, scalar) uniform Push { HashUpdateArgs args; };

void noteDirty(uint bucket) {
  if (bucket == kNoBucket) return;
  const uint bit = 1u << (bucket & 31);
  if ((atomicOr(args.dirty.words[bucket >> 5], bit) & bit) != 0) return;
  const uint at = atomicAdd(args.update.at[0].dirty, 1);
  if (at < args.dirty.capacity) args.dirty.words[dirtyListFrom(args.cloud.grid) + at] = bucket;
}

void main() {
  if (args.update.at[0].failed != 0) return;
  const uint moves = args.update.at[0].moves;
  const uint stride = gl_NumWorkGroups.x * gl_WorkGroupSize.x;
  const bool compacting = args.update.at[0].compacting != 0;
  if (threadIndex() == 0) {
    args.update.at[0].head += args.update.at[0].wanted;
  }
  for (uint base = 0; base < moves; base += stride) {
    const uint i = base + threadIndex();
    bool stays = false;
    uint slot = kEmptySlot;
    if (i < moves) {
      slot = args.moves.at[i].slot;
      const uint id = args.moves.at[i].id;
      const uint from = args.moves.at[i].fromBucket;
      const uint to = args.moves.at[i].toBucket;
      const vec4 position = vec4(args.moves.at[i].position, uintBitsToFloat(id));
      const vec4 normal = vec4(args.moves.at[i].normal, args.moves.at[i].mark);
      if (from == to) {
        args.cloud.positions.at[slot] = position;
        args.cloud.normals.at[slot] = normal;
        stays = args.marks.at[from] == 0;  // otherwise its place in the bucket is not settled yet
      } else {
        if (from != kNoBucket) args.cloud.positions.at[slot].w = uintBitsToFloat(kEmptySlot);
        if (from == kNoBucket) atomicAdd(args.update.at[0].added, 1);
        if (to != kNoBucket) {
          const uint t = args.marks.at[to] - 1;
          const uint at = args.touched.at[t].firstArrival + atomicAdd(args.touched.at[t].placed, 1);
          args.arrivals.at[2 * at] = position;
          args.arrivals.at[2 * at + 1] = normal;
        } else {
          args.moves.at[i].slot = atomicAdd(args.update.at[0].gone, 1);
        }
      }
      if (compacting) {
        noteDirty(from);
        if (to != from) noteDirty(to);
      }
    }
    const uint at = nextChanged(args.update, stays);
    if (stays) args.changed.at[at] = slot;
  }
}
