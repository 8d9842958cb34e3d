#version 460
#extension GL_GOOGLE_include_directive : require
// LSD radix sort, pass 3 of 3: each workgroup ranks its partition by digit, stably, and writes it to the positions from
// the scanned counts. Keys are ranked within a subgroup by matching digits with ballots (Ashkiani et al. 2016,
// multisplit), so no workgroup waits for another and any subgroup size works.
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_shuffle : require
#include "shaders/shared/radix_sort.h"
#include "shaders/lib/index.glsl"
#include "shaders/lib/subgroup_meet.glsl"
#include "shaders/lib/workgroup_scan.glsl"

layout(constant_id = 1) const uint kSubgroups = 8;  // per workgroup

layout(push_constant, scalar) uniform Push { RadixSortArgs args; };

shared uint subgroupCounts[kSubgroups * kSortRadix];         // [subgroup][digit]
shared uint sorted[gl_WorkGroupSize.x * kSortItems];         // keys, then values, in the order of this digit
shared uint destination[kSortRadix];                         // of a digit's first key here, minus its index in `sorted`
shared uint digitStart[kSortRadix];                          // first index of a digit in `sorted`

uint digitOf(uint key) { return (key >> args.shift) & ((1u << args.digitBits) - 1); }

// The invocations of this subgroup whose key has the same digit.
uvec4 peersOf(uint digit) {
  uvec4 peers = subgroupBallot(true);
  for (uint bit = 0; bit < args.digitBits; ++bit) {
    const bool set = ((digit >> bit) & 1) != 0;
    const uvec4 ballot = subgroupBallot(set);
    peers &= set ? ballot : ~ballot;
  }
  return peers;
}

// Turns subgroupCounts into exclusive sums over the subgroups, and fills digitStart and destination.
void scanCounts(uint part, uint radix) {
  const uint perThread = (radix + gl_WorkGroupSize.x - 1) / gl_WorkGroupSize.x;
  const uint firstDigit = scanIndex() * perThread;
  uint sum = 0;
  for (uint d = firstDigit; d < min(firstDigit + perThread, radix); ++d) {
    uint running = 0;
    for (uint s = 0; s < gl_NumSubgroups; ++s) {
      const uint count = subgroupCounts[s * radix + d];
      subgroupCounts[s * radix + d] = running;
      running += count;
    }
    digitStart[d] = sum;
    sum += running;
  }
  uint total;
  const uint before = workgroupExclusiveScan(sum, total);
  for (uint d = firstDigit; d < min(firstDigit + perThread, radix); ++d) {
    digitStart[d] += before;
    destination[d] = args.counts.at[d * args.partitions + part] - digitStart[d];
  }
}

void main() {
  const uint part = workgroupIndex();
  if (part >= args.partitions) return;
  const uint radix = 1u << args.digitBits;
  const uint partitionSize = gl_WorkGroupSize.x * kSortItems;
  const uint partitionStart = part * partitionSize;
  const uint partitionCount = min(partitionSize, args.count - partitionStart);

  for (uint i = gl_LocalInvocationIndex; i < gl_NumSubgroups * radix; i += gl_WorkGroupSize.x) subgroupCounts[i] = 0;
  barrier();

  // A subgroup takes consecutive keys, one row of its size after another, so that rank follows the order of the input.
  const uint mine = gl_SubgroupID * gl_SubgroupSize * kSortItems + gl_SubgroupInvocationID;
  uint keys[kSortItems];
  uint ranks[kSortItems];
  for (uint item = 0; item < kSortItems; ++item) {
    const uint i = mine + item * gl_SubgroupSize;
    // Beyond the end the largest key is used: it ranks behind every true key and is never written.
    keys[item] = i < partitionCount ? args.keysIn.at[partitionStart + i] : 0xFFFFFFFFu;
    const uint digit = digitOf(keys[item]);
    const uvec4 peers = peersOf(digit);
    const uint before = subgroupBallotExclusiveBitCount(peers);
    uint start = 0;
    if (before == 0) start = atomicAdd(subgroupCounts[gl_SubgroupID * radix + digit], subgroupBallotBitCount(peers));
    ranks[item] = subgroupShuffle(start, subgroupBallotFindLSB(peers)) + before;
    subgroupMemoryBarrierShared();
    subgroupMeet();
  }
  barrier();
  scanCounts(part, radix);
  barrier();

  for (uint item = 0; item < kSortItems; ++item) {
    const uint digit = digitOf(keys[item]);
    ranks[item] += digitStart[digit] + subgroupCounts[gl_SubgroupID * radix + digit];
    sorted[ranks[item]] = keys[item];
  }
  barrier();
  uint to[kSortItems];
  for (uint item = 0; item < kSortItems; ++item) {
    const uint place = item * gl_WorkGroupSize.x + gl_LocalInvocationIndex;
    const uint key = sorted[place];
    to[item] = destination[digitOf(key)] + place;
    if (place < partitionCount) args.keysOut.at[to[item]] = key;
  }
  barrier();
  for (uint item = 0; item < kSortItems; ++item) {
    const uint i = mine + item * gl_SubgroupSize;
    if (i < partitionCount) sorted[ranks[item]] = args.valuesIn.at[partitionStart + i];
  }
  barrier();
  for (uint item = 0; item < kSortItems; ++item) {
    const uint place = item * gl_WorkGroupSize.x + gl_LocalInvocationIndex;
    if (place < partitionCount) args.valuesOut.at[to[item]] = sorted[place];
  }
}
