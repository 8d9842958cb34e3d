// Reductions and a scan over a subgroup, for any subgroup size, by shuffles alone: not every GPU has subgroup
// arithmetic. The whole subgroup calls each of them together.
#ifndef PALPATE_LIB_SUBGROUP_REDUCE_GLSL
#define PALPATE_LIB_SUBGROUP_REDUCE_GLSL

#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_shuffle : require

// In a butterfly: all invocations have the same bits of a sum of floats.
#define PALPATE_REDUCE(NAME, TYPE, COMBINED)                          \
  TYPE NAME(TYPE a) {                                                 \
    for (uint lanes = 1; lanes < gl_SubgroupSize; lanes <<= 1) {      \
      const TYPE b = subgroupShuffleXor(a, lanes);                    \
      a = COMBINED;                                                   \
    }                                                                 \
    return a;                                                         \
  }
PALPATE_REDUCE(reduceAdd, uint, a + b)
PALPATE_REDUCE(reduceAdd, int, a + b)
PALPATE_REDUCE(reduceAdd, ivec3, a + b)
PALPATE_REDUCE(reduceAdd, float, a + b)
PALPATE_REDUCE(reduceAdd, vec2, a + b)
PALPATE_REDUCE(reduceAdd, vec4, a + b)
PALPATE_REDUCE(reduceMin, uint, min(a, b))
PALPATE_REDUCE(reduceMin, float, min(a, b))
PALPATE_REDUCE(reduceMin, vec2, min(a, b))
PALPATE_REDUCE(reduceMax, uint, max(a, b))
PALPATE_REDUCE(reduceMax, float, max(a, b))
PALPATE_REDUCE(reduceMax, vec2, max(a, b))
PALPATE_REDUCE(reduceMax, vec3, max(a, b))
PALPATE_REDUCE(reduceOr, uint, a | b)

// Sum of `value` over the invocations before this one; `total` over all (Hillis and Steele 1986).
uint subgroupScan(uint value, out uint total) {
  uint upToHere = value;
  for (uint lanes = 1; lanes < gl_SubgroupSize; lanes <<= 1) {
    const bool adds = gl_SubgroupInvocationID >= lanes;
    const uint before = subgroupShuffle(upToHere, adds ? gl_SubgroupInvocationID - lanes : gl_SubgroupInvocationID);
    upToHere += adds ? before : 0;
  }
  total = subgroupShuffle(upToHere, gl_SubgroupSize - 1);
  return upToHere - value;
}

#endif
