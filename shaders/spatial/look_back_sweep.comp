#version 460
#extension GL_GOOGLE_include_directive : require
// One pass of a look-back radix sort ("onesweep", Adinets and Merrill 2022): each workgroup ranks a tile of keys by
// digit, learns from the tiles before it where its own go, and writes them there. Every key is read and written once a
// pass. A tile waits for earlier ones, so this needs a driver on which workgroups that have started go on; tiles are
// numbered as they start, and the earliest one that is not done never waits.
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_shuffle : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/shared/look_back_sort.h"
#include "shaders/lib/index.glsl"
#include "shaders/lib/workgroup_scan.glsl"

layout(constant_id = 1) const uint kSubgroups = 8;  // per workgroup
layout(constant_id = 2) const uint kItems = 16;     // keys per invocation
layout(constant_id = 3) const uint kDigitBits = 8;

layout(push_constant, scalar) uniform Push { RadixSweepArgs args; };

const uint kRadix = 1u << kDigitBits;
const uint kTile = gl_WorkGroupSize.x * kItems;
const uint kCounters = kSubgroups * kRadix;

// First the counts [subgroup][digit], then keys, then values in the order of this digit.
shared uint pool[kCounters > kTile ? kCounters : kTile];
shared uint digitStart[kRadix];   // of a digit in the sorted tile
shared uint destination[kRadix];  // of a digit's first key here, less its place in the sorted tile
shared uint sharedTile;

uint digitOf(uint key) { return bitfieldExtract(key, int(args.shift), int(kDigitBits)); }

// The invocations of this subgroup whose key has the same digit.
uvec4 peersOf(uint digit) {
  uvec4 peers = subgroupBallot(true);
  [[unroll]] for (uint bit = 0; bit < kDigitBits; ++bit) {
    const bool set = ((digit >> bit) & 1) != 0;
    const uvec4 ballot = subgroupBallot(set);
    peers &= set ? ballot : ~ballot;
  }
  return peers;
}

// Keys of digit `d` in all tiles before this one, from the digit's first place in the output.
uint lookBack(uint tile, uint d) {
  uint sum = 0;
  uint t = tile - 1;
  while (true) {
    const uint word = args.tiles.at[t * kRadix + d];
    if (word < kSweepOwn) continue;
    sum += word & kSweepCountMask;
    if (word >= kSweepAll) return sum;
    --t;
  }
}

void main() {
  if (gl_LocalInvocationIndex == 0) sharedTile = atomicAdd(args.nextTile.at[0], 1);
  for (uint i = gl_LocalInvocationIndex; i < kCounters; i += gl_WorkGroupSize.x) pool[i] = 0;
  barrier();
  const uint tile = sharedTile;
  const uint start = tile * kTile;
  if (start >= args.count) return;
  const uint inTile = min(kTile, args.count - start);

  // A subgroup takes consecutive keys, one row of its size after another, so that rank follows the order of the input.
  const uint mine = gl_SubgroupID * gl_SubgroupSize * kItems + gl_SubgroupInvocationID;
  uint keys[kItems];
  uint ranks[kItems];
  // Past the end the largest key stands in: it ranks behind every true key and is never written.
  [[unroll]] for (uint item = 0; item < kItems; ++item) {
    const uint i = mine + item * gl_SubgroupSize;
    keys[item] = i < inTile ? args.keysIn.at[start + i] : 0xFFFFFFFFu;
  }
  const uint counters = gl_SubgroupID * kRadix;
  [[unroll]] for (uint item = 0; item < kItems; ++item) {
    const uint digit = digitOf(keys[item]);
    const uvec4 peers = peersOf(digit);
    const uint before = subgroupBallotExclusiveBitCount(peers);
    uint first = 0;
    if (before == 0) first = atomicAdd(pool[counters + digit], subgroupBallotBitCount(peers));
    ranks[item] = subgroupShuffle(first, subgroupBallotFindLSB(peers)) + before;
  }
  barrier();

  // One invocation for each digit: its keys in this tile, published before anything else is done with them.
  const uint d = scanIndex();
  uint own = 0;
  if (d < kRadix) {
    for (uint s = 0; s < kSubgroups; ++s) {
      const uint count = pool[s * kRadix + d];
      pool[s * kRadix + d] = own;
      own += count;
    }
    if (tile != 0) args.tiles.at[tile * kRadix + d] = kSweepOwn | own;
  }
  uint total;
  const uint startHere = workgroupExclusiveScan(own, total);
  uint startOfAll = 0;
  if (tile == 0) startOfAll = workgroupExclusiveScan(d < kRadix ? args.histogram.at[d] : 0, total);
  if (d < kRadix) digitStart[d] = startHere;
  barrier();
  [[unroll]] for (uint item = 0; item < kItems; ++item) {
    const uint digit = digitOf(keys[item]);
    ranks[item] += digitStart[digit] + pool[counters + digit];
  }
  barrier();
  [[unroll]] for (uint item = 0; item < kItems; ++item) pool[ranks[item]] = keys[item];
  if (d < kRadix) {
    const uint before = tile == 0 ? startOfAll : lookBack(tile, d);
    args.tiles.at[tile * kRadix + d] = kSweepAll | (before + own);
    destination[d] = before - startHere;
  }
  // The values are on their way while the keys are written.
  uint values[kItems];
  [[unroll]] for (uint item = 0; item < kItems; ++item) {
    const uint i = mine + item * gl_SubgroupSize;
    values[item] = i < inTile ? args.valuesIn.at[start + i] : 0;
  }
  barrier();
  uint to[kItems];
  [[unroll]] for (uint item = 0; item < kItems; ++item) {
    const uint place = item * gl_WorkGroupSize.x + gl_LocalInvocationIndex;
    const uint key = pool[place];
    to[item] = destination[digitOf(key)] + place;
    if (place < inTile) args.keysOut.at[to[item]] = key;
  }
  barrier();
  [[unroll]] for (uint item = 0; item < kItems; ++item) pool[ranks[item]] = values[item];
  barrier();
  [[unroll]] for (uint item = 0; item < kItems; ++item) {
    const uint place = item * gl_WorkGroupSize.x + gl_LocalInvocationIndex;
    if (place < inTile) args.valuesOut.at[to[item]] = pool[place];
  }
}
