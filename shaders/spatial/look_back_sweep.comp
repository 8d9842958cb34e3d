#version 460
#extension GL_GOOGLE_include_directive : require
// One pass of a look-back radix sort ("onesweep", Adinets and Merrill 2022): each workgroup counts a tile of keys by
// digit, determines from the preceding tiles where its own keys go, and writes them there. Every key is read and
// written once a pass. A tile waits for the counts of earlier ones, but only for a limited time: then it counts them
// itself ("decoupled fallback", Smith, Levien and Owens 2025), so that no workgroup has to make progress for another.
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_shuffle : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/shared/look_back_sort.h"
#include "shaders/lib/index.glsl"
#include "shaders/lib/workgroup_scan.glsl"

layout(constant_id = 1) const uint kSubgroups = 12;  // per workgroup
layout(constant_id = 2) const uint kItems = 10;      // keys per invocation
layout(constant_id = 3) const uint kDigitBits = 7;
layout(constant_id = 4) const uint kMaxLooks = 256;  // without news, before this tile counts an earlier one
// For tests: not 0, every so many tiles never tell their counts.
layout(constant_id = 5) const uint kSilent = 0;

layout(push_constant, scalar) uniform Push { RadixSweepArgs args; };

const uint kSubgroupSize = gl_WorkGroupSize.x / kSubgroups;
const uint kRadix = 1u << kDigitBits;
const uint kTile = gl_WorkGroupSize.x * kItems;
const uint kCounters = kSubgroups * kRadix;
const uint kWindow = 4;  // tiles in one step back: their words are in flight together

// First the counts [subgroup][digit], then keys, then values in the order of this digit.
shared uint pool[kCounters > kTile ? kCounters : kTile];
shared uint destination[kRadix];  // of a digit's first key here, minus its index in the sorted tile
shared uint sharedTile;
shared uint sharedMissing;  // 1 + the last tile whose count is missing; 0 if none is

// This invocation's keys, their values, and their indices in the sorted tile.
uint keys[kItems], values[kItems], places[kItems];

// The keys of one digit in this tile, for the invocation of that digit; others have a `digit` beyond kRadix.
struct Own {
  uint tile, digit;
  uint count, start;  // `start`: index of the first one in the sorted tile
  bool tells;         // the tile publishes its counts
};

uint digitOf(uint key) { return bitfieldExtract(key, int(args.shift), int(kDigitBits)); }

// The invocations whose key has the same digit.
uvec4 peersOf(uint digit) {
  uvec4 peers = subgroupBallot(true);
  [[unroll]] for (uint bit = 0; bit < kDigitBits; ++bit) {
    const bool set = ((digit >> bit) & 1) != 0;
    const uvec4 ballot = subgroupBallot(set);
    peers &= set ? ballot : ~ballot;
  }
  return peers;
}

// The next index for a key of this digit, in the order of the subgroup's keys.
uint takePlace(uint digit, uint counters) {
  const uvec4 peers = peersOf(digit);
  uint before, all, leader;
  if (kSubgroupSize <= 32) {
    before = bitCount(peers.x & gl_SubgroupLtMask.x);
    all = bitCount(peers.x);
    leader = findLSB(peers.x);
  } else {
    before = subgroupBallotExclusiveBitCount(peers);
    all = subgroupBallotBitCount(peers);
    leader = subgroupBallotFindLSB(peers);
  }
  uint first = 0;
  if (before == 0) first = atomicAdd(pool[counters + digit], all);
  return subgroupShuffle(first, leader) + before;
}

// Adds to `sum` the keys of digit `d` in the tiles before `end`, then the first that has not published it.
// True if all are known: `sum` is then where the digit's keys of this tile go.
bool lookBack(inout uint end, inout uint sum, uint d) {
  uint looks = 0;
  while (looks < kMaxLooks) {
    uint words[kWindow];
    [[unroll]] for (uint k = 0; k < kWindow; ++k)
      words[k] = k < end ? args.tiles.at[(end - 1 - k) * kRadix + d] : 0;
    ++looks;
    [[unroll]] for (uint k = 0; k < kWindow; ++k) {
      if (words[k] < kSweepOwn) break;  // not known yet: read again
      sum += words[k] & kSweepCountMask;
      if (words[k] >= kSweepAll) return true;
      --end;
      looks = 0;
    }
  }
  return false;
}

// Counts the keys of each digit in an earlier tile, into `destination`. The whole workgroup calls it together.
void countTile(uint tile) {
  for (uint i = gl_LocalInvocationIndex; i < kRadix; i += gl_WorkGroupSize.x) destination[i] = 0;
  barrier();
  [[dont_unroll]] for (uint item = 0; item < kItems; ++item) {
    const uint i = tile * kTile + item * gl_WorkGroupSize.x + gl_LocalInvocationIndex;
    atomicAdd(destination[digitOf(args.keysIn.at[i])], 1);
  }
  barrier();
}

// Publishes the count of a tile that has not done so; returns its word.
uint tellFor(uint tile, uint d, uint word) {
  const uint told = atomicCompSwap(args.tiles.at[tile * kRadix + d], 0, word);
  return told == 0 ? word : told;
}

// Reads the keys of this tile, and counts them by subgroup.
void readKeys(uint start, uint inTile, uint mine, uint counters) {
  // Beyond the end the largest key is used: it ranks behind every true key and is never written.
  [[unroll]] for (uint item = 0; item < kItems; ++item) {
    const uint i = mine + item * kSubgroupSize;
    keys[item] = i < inTile ? args.keysIn.at[start + i] : 0xFFFFFFFFu;
  }
  // Counted before they are ranked, which takes longer: later tiles wait only for the counts.
  [[unroll]] for (uint item = 0; item < kItems; ++item) atomicAdd(pool[counters + digitOf(keys[item])], 1);
}

void readValues(uint start, uint inTile, uint mine) {
  [[unroll]] for (uint item = 0; item < kItems; ++item) {
    const uint i = mine + item * kSubgroupSize;
    if (i < inTile) values[item] = args.valuesIn.at[start + i];
  }
}

// Turns the counts of a digit into the indices of its first key of each subgroup.
void countsToPlaces(Own own) {
  uint next = own.start;
  for (uint s = 0; s < kSubgroups; ++s) {
    const uint count = pool[s * kRadix + own.digit];
    pool[s * kRadix + own.digit] = next;
    next += count;
  }
}

// Where all keys of digit `d` begin, for the whole workgroup together.
uint startOfDigit(uint d) {
  uint total;
  return workgroupExclusiveScan(d < kRadix ? args.histogram.at[d] : 0, total);
}

// Looks back at the tiles before this one. Returns whether all have published their counts: else `end` ends the tiles
// that are still to be added to `before`.
bool lookForStart(Own own, uint startOfAll, inout uint end, inout uint before) {
  bool knows = true;
  if (own.tile == 0)
    before = startOfAll;
  else
    knows = lookBack(end, before, own.digit);
  if (knows) {
    if (own.tells) args.tiles.at[own.tile * kRadix + own.digit] = kSweepAll | (before + own.count);
    destination[own.digit] = before - own.start;
  } else {
    atomicMax(sharedMissing, end);
  }
  return knows;
}

// Counts the tiles that have not published their counts, the last one first. The whole workgroup calls it together.
void countMissing(Own own, uint end, uint before, bool knows) {
  while (sharedMissing != 0) {
    const uint missing = sharedMissing;
    barrier();
    if (gl_LocalInvocationIndex == 0) sharedMissing = 0;
    countTile(missing - 1);
    uint first = 0;
    if (missing == 1) first = startOfDigit(own.digit);
    if (!knows && end == missing) {
      const uint word =
          tellFor(missing - 1, own.digit, (missing == 1 ? kSweepAll : kSweepOwn) | (first + destination[own.digit]));
      before += word & kSweepCountMask;
      --end;
      knows = word >= kSweepAll || lookBack(end, before, own.digit);
      if (knows && own.tells) args.tiles.at[own.tile * kRadix + own.digit] = kSweepAll | (before + own.count);
    }
    barrier();
    if (own.digit < kRadix && knows) destination[own.digit] = before - own.start;
    if (!knows) atomicMax(sharedMissing, end);
    barrier();
  }
}

// Writes the sorted tile: its keys, which are in `pool`, then its values.
void writeTile(uint inTile) {
  [[unroll]] for (uint item = 0; item < kItems; ++item) {
    const uint place = item * gl_WorkGroupSize.x + gl_LocalInvocationIndex;
    const uint key = pool[place];
    const uint digit = digitOf(key);
    if (place < inTile) args.keysOut.at[destination[digit] + place] = key;
    places[item] |= digit << 16;  // also for the value that goes there
  }
  barrier();
  [[unroll]] for (uint item = 0; item < kItems; ++item) pool[places[item] & 0xFFFFu] = values[item];
  barrier();
  [[unroll]] for (uint item = 0; item < kItems; ++item) {
    const uint place = item * gl_WorkGroupSize.x + gl_LocalInvocationIndex;
    if (place < inTile) args.valuesOut.at[destination[places[item] >> 16] + place] = pool[place];
  }
}

void main() {
  if (gl_LocalInvocationIndex == 0) sharedTile = atomicAdd(args.nextTile.at[0], 1);
  for (uint i = gl_LocalInvocationIndex; i < kCounters; i += gl_WorkGroupSize.x) pool[i] = 0;
  barrier();
  Own own;
  own.tile = sharedTile;
  const uint start = own.tile * kTile;
  if (start >= args.count) return;
  const uint inTile = min(kTile, args.count - start);
  own.tells = kSilent == 0 || own.tile % max(kSilent, 1) != 0;

  // A subgroup takes consecutive keys, one row of its size after another, so that rank follows the order of the input.
  const uint mine = gl_SubgroupID * kSubgroupSize * kItems + gl_SubgroupInvocationID;
  const uint counters = gl_SubgroupID * kRadix;
  readKeys(start, inTile, mine, counters);
  barrier();
  if (gl_LocalInvocationIndex == 0) sharedMissing = 0;

  own.digit = scanIndex();
  own.count = 0;
  if (own.digit < kRadix) {
    for (uint s = 0; s < kSubgroups; ++s) own.count += pool[s * kRadix + own.digit];
    if (own.tile != 0 && own.tells) args.tiles.at[own.tile * kRadix + own.digit] = kSweepOwn | own.count;
  }
  uint total;
  own.start = workgroupExclusiveScan(own.count, total);
  uint startOfAll = 0;
  if (own.tile == 0) startOfAll = startOfDigit(own.digit);
  if (own.digit < kRadix) countsToPlaces(own);
  barrier();
  [[unroll]] for (uint item = 0; item < kItems; ++item) places[item] = takePlace(digitOf(keys[item]), counters);
  barrier();
  [[unroll]] for (uint item = 0; item < kItems; ++item) pool[places[item]] = keys[item];
  readValues(start, inTile, mine);  // in flight while this looks back and writes the keys
  uint end = own.tile, before = 0;
  bool knows = true;
  if (own.digit < kRadix) knows = lookForStart(own, startOfAll, end, before);
  barrier();
  countMissing(own, end, before, knows);
  writeTile(inTile);
}
