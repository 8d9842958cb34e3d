#version 460
#extension GL_GOOGLE_include_directive : require
// Index update: in every bucket with moves, remaining points get the positions of their moves, leaving points leave no
// gap, and arriving points follow in the order of their ids, or all are kept in that order: in its slots or, if it
// outgrows them, in new ones. One subgroup for each bucket. If the update is refused it only clears the marks.
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_KHR_shader_subgroup_shuffle : require
#extension GL_KHR_shader_subgroup_vote : require
#include "shaders/lib/index.glsl"
#include "shaders/lib/hash_update.glsl"
#include "shaders/lib/subgroup_meet.glsl"
#include "shaders/lib/subgroup_reduce.glsl"

layout(push_constant, scalar) uniform Push { HashUpdateArgs args; };

// Not 0: buckets keep their points in the order of the ids, as a build leaves them, and changed slots are not listed.
layout(constant_id = 2) const uint kInOrder = 0;

uint moves;  // number of listed moves

void leaveEmpty(uint slot) { args.cloud.positions.at[slot].w = uintBitsToFloat(kEmptySlot); }
vec4 placeOf(PointMove move) { return vec4(move.position, uintBitsToFloat(move.id)); }
vec4 normalOf(PointMove move) { return vec4(move.normal, move.mark); }

void noteDirty(uint bucket) {
  const uint bit = 1u << (bucket & 31);
  if ((atomicOr(args.dirty.words[bucket >> 5], bit) & bit) != 0) return;
  const uint at = atomicAdd(args.update.at[0].dirty, 1);
  if (at < args.dirty.capacity) args.dirty.words[dirtyListFrom(args.cloud.grid) + at] = bucket;
}

// The new slots of a bucket: the last move that took slots took the most.
uint newSlots(uint mark) {
  uint move = mark & kMarkMove;
  while (args.moves.at[move - 1].room == kEmptySlot) move = args.moves.at[move - 1].before;
  return args.moves.at[move - 1].room;
}

void noteChanged(bool changed, uint slot) {
  if (kInOrder != 0) return;
  const uint at = nextChanged(args.update, changed);
  if (changed) args.changed.at[at] = slot;
}

// Moves the points that stay to `to` and on, in order; returns their end, and the number of this invocation's points
// that are removed. Source and target may be the same slots.
uint closeGaps(uint bucket, uvec2 range, uint to, out uint gone) {
  gone = 0;
  const bool relocates = to != range.x;
  for (uint base = range.x; base < range.y; base += gl_SubgroupSize) {
    const uint slot = base + gl_SubgroupInvocationID;
    vec4 position = vec4(0.0), normal = vec4(0.0);
    bool stays = false, moved = false;
    if (slot < range.y) {
      position = args.cloud.positions.at[slot];
      normal = args.cloud.normals.at[slot];
      const uint i = args.movesOf.at[slot];
      PointMove move;
      if (i < moves) move = args.moves.at[i];
      moved = i < moves && move.slot == slot;
      stays = !moved || move.toBucket == bucket;
      if (moved && stays) {
        position = placeOf(move);
        normal = normalOf(move);
      } else if (moved && move.toBucket == kNoBucket) {
        args.moves.at[i].room = atomicAdd(args.update.at[0].gone, 1);
        ++gone;
      }
    }
    const uvec4 ballot = subgroupBallot(stays);
    subgroupMemoryBarrierBuffer();  // all have read before any writes
    subgroupMeet();
    const uint place = to + subgroupBallotExclusiveBitCount(ballot);
    if (stays && (moved || place != slot)) {
      args.cloud.positions.at[place] = position;
      args.cloud.normals.at[place] = normal;
    }
    if (relocates && slot < range.y) leaveEmpty(slot);
    noteChanged(stays && moved, place);
    to += subgroupBallotBitCount(ballot);
  }
  return to;
}

// Arrivals of buckets where more points arrive than a subgroup holds, move and id, after the list of touched buckets.
layout(buffer_reference, scalar, buffer_reference_align = 4) coherent buffer Arrivals { uvec2 at[]; };

// Follows the arrivals from a mark. Each invocation keeps the one of its number; if there are more, all of them are in
// the list from `run` on.
uvec2 arrivalOf(uint mark, Arrivals list, out uint run) {
  const uint arrivals = arrivalsOf(mark);
  const bool spills = arrivals > gl_SubgroupSize;
  run = 0;
  if (spills && subgroupElect()) run = atomicAdd(args.update.at[0].arrivals, arrivals);
  run = args.mostMoves + subgroupBroadcastFirst(run);
  uvec2 first = uvec2(0, kEmptySlot), mine = first;
  uint next = mark & kMarkMove;
  for (uint base = 0; base < arrivals; base += gl_SubgroupSize) {
    const uint count = min(gl_SubgroupSize, arrivals - base);
    for (uint lane = 0; lane < count; ++lane) {
      const PointMove move = args.moves.at[next - 1];
      if (lane == gl_SubgroupInvocationID) mine = uvec2(next - 1, move.id);
      next = move.before;
    }
    if (base == 0) first = mine;
    if (spills && gl_SubgroupInvocationID < count) list.at[run + base + gl_SubgroupInvocationID] = mine;
  }
  subgroupMemoryBarrierBuffer();
  subgroupMeet();
  return first;
}

// Words by slot that invocations of a subgroup write for each other.
layout(buffer_reference, scalar, buffer_reference_align = 8) coherent buffer SharedUints { uint at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 16) coherent buffer SharedVec4s { vec4 at[]; };

void subgroupShares() {
  subgroupMemoryBarrierBuffer();
  subgroupMeet();
}

// Number of points with a smaller id among those in the slots `range`, which are in the order of their ids.
uint pointsBefore(uvec2 range, uint id) {
  SharedVec4s positions = SharedVec4s(uvec2(args.cloud.positions));
  uint low = range.x, high = range.y;
  while (low < high) {
    const uint middle = (low + high) / 2;
    if (floatBitsToUint(positions.at[middle].w) < id)
      low = middle + 1;
    else
      high = middle;
  }
  return low - range.x;
}

// Number of the arriving points that go before the `point`-th of those that stay. In the words of the slots `arriving`
// is, for each in the order of the ids, the number of points that stay before it.
uint arrivalsBefore(uvec2 arriving, uint point) {
  SharedUints staying = SharedUints(uvec2(args.movesOf));
  uint low = arriving.x, high = arriving.y;
  while (low < high) {
    const uint middle = (low + high) / 2;
    if (staying.at[middle] <= point)
      low = middle + 1;
    else
      high = middle;
  }
  return low - arriving.x;
}

// Makes room for the arriving points among those that stay, in the slots `kept`: the last ones move first.
void makeRoom(uvec2 kept, uvec2 arriving) {
  for (uint end = kept.y; end > kept.x;) {
    const uint begin = end - min(end - kept.x, gl_SubgroupSize);
    const uint slot = begin + gl_SubgroupInvocationID;
    vec4 position = vec4(0.0), normal = vec4(0.0);
    uint way = 0;
    if (slot < end) {
      position = SharedVec4s(uvec2(args.cloud.positions)).at[slot];
      normal = SharedVec4s(uvec2(args.cloud.normals)).at[slot];
      way = arrivalsBefore(arriving, slot - kept.x);
    }
    subgroupShares();  // all have read before any writes
    if (way > 0) {
      args.cloud.positions.at[slot + way] = position;
      args.cloud.normals.at[slot + way] = normal;
    }
    if (!subgroupAny(way > 0)) break;
    end = begin;
  }
}

// Writes an arriving point to its slot; returns 1 if it is new.
uint place(uint at, uint slot) {
  const PointMove move = args.moves.at[at];
  args.cloud.positions.at[slot] = placeOf(move);
  args.cloud.normals.at[slot] = normalOf(move);
  return move.fromBucket == kNoBucket ? 1 : 0;
}

// Inserts them into the slots `kept` of the points that stay and those behind, in the order of all ids, or behind them;
// returns the number of this invocation's that are new.
uint takeIn(uint mark, uvec2 kept) {
  const uint arrivals = arrivalsOf(mark);
  if (arrivals == 0) return 0;
  Arrivals list = Arrivals(uvec2(args.touched));
  uint run;
  const uvec2 first = arrivalOf(mark, list, run);
  uint added = 0;
  for (uint base = 0; base < arrivals; base += gl_SubgroupSize) {
    const uint own = base + gl_SubgroupInvocationID;
    const bool takes = own < arrivals;
    uvec2 mine = first;
    if (base > 0) mine = takes ? list.at[run + own] : uvec2(0, kEmptySlot);
    uint rank = 0;
    for (uint others = 0; others < arrivals; others += gl_SubgroupSize) {
      const uint other = others + gl_SubgroupInvocationID;
      uint otherId = mine.y;
      if (others != base && other < arrivals) otherId = list.at[run + other].y;
      const uint count = min(gl_SubgroupSize, arrivals - others);
      for (uint lane = 0; lane < count; ++lane) rank += subgroupShuffle(otherId, lane) < mine.y ? 1 : 0;
    }
    if (takes && kInOrder != 0) {
      const uint before = pointsBefore(kept, mine.y);
      SharedUints(uvec2(args.movesOf)).at[kept.y + rank] = before;
      args.moves.at[mine.x].before = kept.x + before + rank;
    } else if (takes) {
      added += place(mine.x, kept.y + rank);
    }
    noteChanged(takes, kept.y + rank);
  }
  if (kInOrder == 0) return added;
  subgroupShares();
  makeRoom(kept, uvec2(kept.y, kept.y + arrivals));
  subgroupShares();
  for (uint own = gl_SubgroupInvocationID; own < arrivals; own += gl_SubgroupSize) {
    const uint move = own < gl_SubgroupSize ? first.x : list.at[run + own].x;
    added += place(move, args.moves.at[move].before);
  }
  return added;
}

// The whole subgroup calls it together.
void update(uint bucket) {
  const uint mark = args.marks.at[bucket];
  const uvec2 range = args.cloud.ranges.at[bucket];
  const uint points = range.y - range.x, arrivals = arrivalsOf(mark);
  const uint before = max(args.capacities.at[bucket], points);
  // Leaving points are not subtracted: a bucket may grow early, never late.
  const uint capacity = capacityFor(before, points + arrivals);
  const uint first = capacity == before ? range.x : newSlots(mark);
  uint gone;
  const uint kept = closeGaps(bucket, range, first, gone);
  const uint end = kept + arrivals;
  if (first == range.x)
    for (uint slot = end + gl_SubgroupInvocationID; slot < range.y; slot += gl_SubgroupSize) leaveEmpty(slot);
  if (kInOrder != 0) subgroupShares();
  const uint more = reduceAdd(takeIn(mark, uvec2(first, kept)) - gone);
  if (!subgroupElect()) return;
  if (more != 0) atomicAdd(args.update.at[0].points, more);
  if (args.update.at[0].compacting != 0) noteDirty(bucket);
  args.cloud.ranges.at[bucket] = uvec2(first, end);
  args.capacities.at[bucket] = capacity;
}

void main() {
  const uint touched = args.update.at[0].touched;
  const uint refused = args.update.at[0].failed | args.update.at[0].refused;
  moves = min(args.update.at[0].moves, args.mostMoves);
  if (threadIndex() == 0) {
    if (refused != 0)
      args.update.at[0].failed = refused;
    else
      args.update.at[0].head += args.update.at[0].grown;
  }
  const uint stride = gl_NumWorkGroups.x * gl_NumSubgroups;
  for (uint t = workgroupIndex() * gl_NumSubgroups + gl_SubgroupID; t < touched; t += stride) {
    const uint bucket = args.touched.at[t];
    if (refused == 0) update(bucket);
    if (subgroupElect()) args.marks.at[bucket] = 0;
  }
}
