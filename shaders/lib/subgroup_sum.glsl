// The four sums of a vector's components over a subgroup, in six steps instead of twenty: in each of the first two, an
// invocation passes on the components that it does not sum up itself.
#ifndef PALPATE_LIB_SUBGROUP_SUM_GLSL
#define PALPATE_LIB_SUBGROUP_SUM_GLSL

#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_shuffle : require

// Component gl_SubgroupInvocationID % 4 of the sum. The whole subgroup, of 4 invocations at least, calls it together.
float subgroupComponentSum(vec4 v) {
  const bool odd = (gl_SubgroupInvocationID & 1) != 0, upper = (gl_SubgroupInvocationID & 2) != 0;
  const vec2 handed = odd ? v.xz : v.yw;
  const vec2 two = (odd ? v.yw : v.xz) + vec2(subgroupShuffleXor(handed.x, 1), subgroupShuffleXor(handed.y, 1));
  float sum = (upper ? two.y : two.x) + subgroupShuffleXor(upper ? two.x : two.y, 2);
  if (gl_SubgroupSize > 4) sum += subgroupShuffleXor(sum, 4);
  if (gl_SubgroupSize > 8) sum += subgroupShuffleXor(sum, 8);
  if (gl_SubgroupSize > 16) sum += subgroupShuffleXor(sum, 16);
  if (gl_SubgroupSize > 32) sum += subgroupShuffleXor(sum, 32);
  if (gl_SubgroupSize > 64) sum += subgroupShuffleXor(sum, 64);
  return sum;
}

// All four sums, for all invocations.
vec4 subgroupSum(vec4 v) {
  const float sum = subgroupComponentSum(v);
  return vec4(subgroupShuffle(sum, 0), subgroupShuffle(sum, 1), subgroupShuffle(sum, 2), subgroupShuffle(sum, 3));
}

#endif
