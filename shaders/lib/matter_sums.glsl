// Sums over the slots of a block, always in the same order. In rows of blocks: what walls got and the kinetic energy,
// momentum and the most compression; then for each tool the impulse it got, and the angular one, and for the
// model.
#ifndef PALPATE_LIB_MATTER_SUMS_GLSL
#define PALPATE_LIB_MATTER_SUMS_GLSL
#extension GL_EXT_control_flow_attributes : require

const uint kRowsOfAll = 2;
const uint kSummedAtOnce = 8;

shared vec4 summed[2 * kMatterBlock];

// `keepsLargest`: of the last component.
vec4 combined(vec4 a, vec4 b, bool keepsLargest) {
  return vec4(a.xyz + b.xyz, keepsLargest ? max(a.w, b.w) : a.w + b.w);
}

// One value from eight, `left` of them, for both; then the next ones may read them. Who writes one is the only one that
// reads it.
void addEight(uint left, bool keepsLargest) {
  const uint local = gl_LocalInvocationIndex, begin = local < left ? 0 : kMatterBlock;
  if (local < 2 * left) {
    const uint own = begin + local % left;
    vec4 sum = summed[own];
    for (uint k = 1; k < 8; ++k) sum = combined(sum, summed[own + k * left], keepsLargest && begin != 0);
    summed[own] = sum;
  }
  barrier();
}

vec4 lastOf(uint begin, bool keepsLargest) {
  return combined(combined(summed[begin], summed[begin + 1], keepsLargest),
                  combined(summed[begin + 2], summed[begin + 3], keepsLargest), keepsLargest);
}

// Both become their sums over the workgroup, of kMatterBlock invocations, all of which call this together. Of the last
// component of `b` the largest is kept where that is asked for.
void addUp(inout vec4 a, inout vec4 b, bool keepsLargest) {
  summed[gl_LocalInvocationIndex] = a;
  summed[kMatterBlock + gl_LocalInvocationIndex] = b;
  barrier();
  addEight(kMatterBlock / 8, keepsLargest);
  addEight(kMatterBlock / 64, keepsLargest);
  a = lastOf(0, false);
  b = lastOf(kMatterBlock, keepsLargest);
  barrier();
}

// Of the row `row` and the next one, of `width` blocks, the first ones summed up, for all invocations of a workgroup.
void sumRows(Vec4s sums, uint row, uint width, uint blocks, bool keepsLargest, out vec4 a, out vec4 b) {
  a = b = vec4(0);
  for (uint begin = gl_LocalInvocationIndex; begin < blocks; begin += kSummedAtOnce * kMatterBlock) {
    vec4 as[kSummedAtOnce], bs[kSummedAtOnce];  // all of them are asked for before the first one is waited for
    [[unroll]] for (uint k = 0; k < kSummedAtOnce; ++k) {
      const uint block = min(begin + k * kMatterBlock, blocks - 1);
      as[k] = sums.at[row * width + block];
      bs[k] = sums.at[(row + 1) * width + block];
    }
    [[unroll]] for (uint k = 0; k < kSummedAtOnce; ++k) {
      if (begin + k * kMatterBlock >= blocks) continue;
      a = combined(a, as[k], false);
      b = combined(b, bs[k], keepsLargest);
    }
  }
  addUp(a, b, keepsLargest);
}

#endif
