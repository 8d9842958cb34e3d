#version 460
#extension GL_GOOGLE_include_directive : require
// Index update, 3 of 3: every touched bucket closes its gaps, in order, and takes its arrivals in by the order of their
// ids, in place or in its new slots. One subgroup for each. When the plan did not come out it clears the marks alone.
#extension GL_KHR_shader_subgroup_shuffle : require
#include "shaders/lib/index.glsl"
#include "shaders/lib/hash_update.glsl"

layout(push_constant, scalar) uniform Push { HashUpdateArgs args; };

uint idOf(vec4 position) { return floatBitsToUint(position.w); }
void leaveEmpty(uint slot) { args.cloud.positions.at[slot].w = uintBitsToFloat(kEmptySlot); }

void noteChanged(bool changed, uint slot) {
  const uint at = nextChanged(args.update, changed);
  if (changed) args.changed.at[at] = slot;
}

// Brings the points that stay to `to` and on, in order; says where they end. They may be the same slots.
uint closeGaps(uvec2 range, uint to) {
  const bool moves = to != range.x;
  for (uint base = range.x; base < range.y; base += gl_SubgroupSize) {
    const uint slot = base + gl_SubgroupInvocationID;
    vec4 position = vec4(0.0), normal = vec4(0.0);
    bool stays = false;
    if (slot < range.y) {
      position = args.cloud.positions.at[slot];
      normal = args.cloud.normals.at[slot];
      stays = idOf(position) != kEmptySlot;
    }
    const uvec4 ballot = subgroupBallot(stays);
    subgroupMemoryBarrierBuffer();  // all have read before any writes
    subgroupBarrier();
    const uint place = to + subgroupBallotExclusiveBitCount(ballot);
    if (stays && place != slot) {
      args.cloud.positions.at[place] = position;
      args.cloud.normals.at[place] = normal;
    }
    if (moves && stays) leaveEmpty(slot);
    noteChanged(stays && normal.w != 0.0, place);
    to += subgroupBallotBitCount(ballot);
  }
  return to;
}

// Takes a run of arrivals in from slot `to` on, by their ids.
void takeIn(uint first, uint count, uint to) {
  for (uint base = 0; base < count; base += gl_SubgroupSize) {
    const uint i = base + gl_SubgroupInvocationID;
    const bool mine = i < count;
    vec4 position = vec4(0.0);
    if (mine) position = args.arrivals.at[2 * (first + i)];
    uint rank = 0;
    for (uint others = 0; others < count; others += gl_SubgroupSize) {
      const uint j = others + gl_SubgroupInvocationID;
      const uint id = j < count ? idOf(args.arrivals.at[2 * (first + j)]) : kEmptySlot;
      for (uint lane = 0; lane < gl_SubgroupSize; ++lane) rank += subgroupShuffle(id, lane) < idOf(position) ? 1 : 0;
    }
    if (mine) {
      args.cloud.positions.at[to + rank] = position;
      args.cloud.normals.at[to + rank] = args.arrivals.at[2 * (first + i) + 1];
    }
    noteChanged(mine, to + rank);
  }
}

void main() {
  const uint touched = args.update.at[0].touched;
  const bool failed = args.update.at[0].failed != 0;
  const uint stride = gl_NumWorkGroups.x * gl_NumSubgroups;
  for (uint t = workgroupIndex() * gl_NumSubgroups + gl_SubgroupID; t < touched; t += stride) {
    const uint bucket = args.touched.at[t].bucket;
    if (subgroupElect()) args.marks.at[bucket] = 0;
    if (failed) continue;
    const uvec2 range = args.cloud.ranges.at[bucket];
    const uint first = args.touched.at[t].firstSlot;
    const uint arrivals = args.touched.at[t].arrivals;
    const uint kept = closeGaps(range, first);
    const uint end = kept + arrivals;
    if (first == range.x)
      for (uint slot = end + gl_SubgroupInvocationID; slot < range.y; slot += gl_SubgroupSize) leaveEmpty(slot);
    takeIn(args.touched.at[t].firstArrival, arrivals, kept);
    if (subgroupElect()) {
      args.cloud.ranges.at[bucket] = uvec2(first, end);
      args.capacities.at[bucket] = args.touched.at[t].capacity;
    }
  }
}
