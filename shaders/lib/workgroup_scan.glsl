// Sums and prefix sums over a workgroup, for any subgroup size. Every invocation of the workgroup must call them
// together.
#ifndef PALPATE_LIB_WORKGROUP_SCAN_GLSL
#define PALPATE_LIB_WORKGROUP_SCAN_GLSL

#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require

const uint kMaxSubgroups = 64;       // 256 invocations in subgroups of 4
const uint kMaxScanSubgroups = 128;  // 512 invocations, for which only counts and sums are used
// In a structure: an array of as many uints as one in a buffer would get that one's layout, which is invalid here.
struct SubgroupSum {
  uint sum;
};
shared SubgroupSum subgroupSums[kMaxScanSubgroups];

// Sum of `value` over the invocations before this one; `total` over all. Invocations are ordered by (gl_SubgroupID,
// gl_SubgroupInvocationID), as callers index their data.
uint workgroupExclusiveScan(uint value, out uint total) {
  const uint inSubgroup = subgroupExclusiveAdd(value);
  const uint subgroupTotal = subgroupAdd(value);
  if (subgroupElect()) subgroupSums[gl_SubgroupID].sum = subgroupTotal;
  barrier();
  uint before = 0;
  total = 0;
  for (uint s = 0; s < gl_NumSubgroups; ++s) {
    const uint sum = subgroupSums[s].sum;
    before += s < gl_SubgroupID ? sum : 0;
    total += sum;
  }
  barrier();
  return before + inSubgroup;
}

// Index of this invocation in that order.
uint scanIndex() { return gl_SubgroupID * gl_SubgroupSize + gl_SubgroupInvocationID; }

#endif
