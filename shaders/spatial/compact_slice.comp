#version 460
#extension GL_GOOGLE_include_directive : require
// Compaction, 1 of 4: a slice of the background copy. Each workgroup takes 256 buckets, assigns them consecutive slots
// of the back half and copies their points there, each bucket in its order. Edits may change a bucket while it is read:
// it is noted and copied again, and the data read here must only be harmless.
#include "shaders/lib/index.glsl"
#include "shaders/lib/hash_compaction.glsl"
#include "shaders/lib/workgroup_scan.glsl"

layout(push_constant, scalar) uniform Push { CompactionArgs args; };

shared uint starts[kUpdateWorkgroup];  // slots of the buckets before this one, in this workgroup
shared uint firsts[kUpdateWorkgroup];  // its first slot in the source half
shared uint target;

void emptySlots(uvec2 slots) {
  const uint stride = gl_NumWorkGroups.x * gl_NumWorkGroups.y * gl_WorkGroupSize.x;
  for (uint slot = slots.x + threadIndex(); slot < slots.y; slot += stride) {
    args.positions.at[slot] = vec4(vec3(0.0), uintBitsToFloat(kEmptySlot));
    args.normals.at[slot] = vec4(0.0);
  }
}

// The last bucket whose slots begin at or before `slot`; unrolled, since a loop would count against the work that one
// software driver allows an invocation.
uint ownerOf(uint slot) {
  uint owner = 0;
  if (starts[owner + 128] <= slot) owner += 128;
  if (starts[owner + 64] <= slot) owner += 64;
  if (starts[owner + 32] <= slot) owner += 32;
  if (starts[owner + 16] <= slot) owner += 16;
  if (starts[owner + 8] <= slot) owner += 8;
  if (starts[owner + 4] <= slot) owner += 4;
  if (starts[owner + 2] <= slot) owner += 2;
  if (starts[owner + 1] <= slot) owner += 1;
  return owner;
}

void main() {
  const CompactionSlice slice = args.slice.at[0];
  emptySlots(slice.slots);
  const uint lane = scanIndex();
  const uint bucket = slice.buckets.x + workgroupIndex() * kUpdateWorkgroup + lane;
  const bool mine = bucket < slice.buckets.y;
  uvec2 range = uvec2(0);
  if (mine) range = soundRange(args.from.ranges.at[bucket], args.from.slots);
  const uint count = range.y - range.x;
  // More points than slots mean torn ranges. Sums of count / 256 and of sound counts stay within 32 bits.
  uint whole, total;
  workgroupExclusiveScan(count >> 8, whole);
  const bool sound = whole <= args.from.slots >> 8;
  const uint start = workgroupExclusiveScan(sound ? count : 0, total);
  starts[lane] = start;
  firsts[lane] = range.x;
  if (lane == 0) {
    uint first = atomicAdd(args.state.at[0].head, total);
    if (!sound || first > args.from.slots || total > args.from.slots - first) {
      atomicOr(args.state.at[0].failed, kCompactionNoSlots);
      first = kEmptySlot;
    }
    target = first;
  }
  barrier();
  if (target == kEmptySlot) return;
  if (mine) {
    args.ranges.at[bucket] = uvec2(target + start, target + start + count);
    args.capacities.at[bucket] = count;
  }
  for (uint i = lane; i < total; i += kUpdateWorkgroup) {
    const uint owner = ownerOf(i);
    const uint from = firsts[owner] + i - starts[owner];
    args.positions.at[target + i] = args.from.positions.at[from];
    args.normals.at[target + i] = args.from.normals.at[from];
  }
}
