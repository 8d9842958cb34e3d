// Sums over the slots of a block, always in the same order. In rows of blocks: impulse on the walls and the kinetic
// energy, momentum and the maximum compression; then for each tool, and for the model, its impulse, and its angular
// impulse.
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

// Reduces both by a factor of eight, to `left` values; then the next step may read them. A written value is read by its
// writer alone.
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

// Both become their sums over the workgroup, of kMatterBlock invocations, all of which call this together. With
// `keepsLargest` the last component of `b` becomes the maximum.
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

// Sums of the rows `row` and `row` + 1, of `width` blocks, over the first `blocks`; for all invocations of a workgroup.
void sumRows(Vec4s sums, uint row, uint width, uint blocks, bool keepsLargest, out vec4 a, out vec4 b) {
  a = b = vec4(0);
  for (uint begin = gl_LocalInvocationIndex; begin < blocks; begin += kSummedAtOnce * kMatterBlock) {
    vec4 as[kSummedAtOnce], bs[kSummedAtOnce];  // all loads are issued before the first one is needed
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
