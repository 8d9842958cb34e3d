// Sums and prefix sums over a workgroup, for any subgroup size. Every invocation of the workgroup must call them
// together.
#ifndef PALPATE_LIB_WORKGROUP_SCAN_GLSL
#define PALPATE_LIB_WORKGROUP_SCAN_GLSL

#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/lib/subgroup_reduce.glsl"

const uint kMaxSubgroups = 64;       // 256 invocations in subgroups of 4
const uint kMaxScanSubgroups = 128;  // 512 invocations, for which only counts and sums are used
// In a structure: an array of as many uints as one in a buffer would get that one's layout, which is invalid here.
struct SubgroupSum {
  uint sum;
};
shared SubgroupSum subgroupSums[kMaxScanSubgroups];

// Sums of subgroups that an invocation loads at once.
const uint kSumsInFlight = 4;

// Of the sums that the subgroups have left: those before this subgroup, and all.
uint sumBefore(out uint total) {
  uint before = 0;
  total = 0;
  for (uint s = 0; s < gl_NumSubgroups; s += kSumsInFlight) {
    [[unroll]] for (uint i = 0; i < kSumsInFlight; ++i) {
      const uint sum = s + i < gl_NumSubgroups ? subgroupSums[s + i].sum : 0;
      before += s + i < gl_SubgroupID ? sum : 0;
      total += sum;
    }
  }
  return before;
}

// Sum of `value` over the invocations before this one; `total` over all. Invocations are ordered by (gl_SubgroupID,
// gl_SubgroupInvocationID), as callers index their data.
uint workgroupExclusiveScan(uint value, out uint total) {
  uint sum;
  const uint inSubgroup = subgroupScan(value, sum);
  if (subgroupElect()) subgroupSums[gl_SubgroupID].sum = sum;
  barrier();
  const uint before = sumBefore(total);
  barrier();
  return before + inSubgroup;
}

// The same for a value of 0 or 1.
uint workgroupExclusiveCount(bool counts, out uint total) {
  const uvec4 mask = subgroupBallot(counts);
  if (subgroupElect()) subgroupSums[gl_SubgroupID].sum = subgroupBallotBitCount(mask);
  barrier();
  const uint before = sumBefore(total);
  barrier();
  return before + subgroupBallotExclusiveBitCount(mask);
}

// For two such values: those of `second` come after all of `first`. Up to 32767 invocations.
uvec2 workgroupExclusiveCounts(bool first, bool second, out uint total) {
  const uvec4 ofFirst = subgroupBallot(first), ofSecond = subgroupBallot(second);
  if (subgroupElect())
    subgroupSums[gl_SubgroupID].sum = subgroupBallotBitCount(ofFirst) | subgroupBallotBitCount(ofSecond) << 16;
  barrier();
  uint totals;
  const uint before = sumBefore(totals), firsts = totals & 0xffff;
  barrier();
  total = firsts + (totals >> 16);
  return uvec2((before & 0xffff) + subgroupBallotExclusiveBitCount(ofFirst),
               firsts + (before >> 16) + subgroupBallotExclusiveBitCount(ofSecond));
}

// Index of this invocation in that order.
uint scanIndex() { return gl_SubgroupID * gl_SubgroupSize + gl_SubgroupInvocationID; }

#endif
