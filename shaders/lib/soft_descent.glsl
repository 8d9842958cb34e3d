// The vectors and sums of a soft body's compliance. Requires `args` as SoftDescentArgs.
#ifndef PALPATE_LIB_SOFT_DESCENT_GLSL
#define PALPATE_LIB_SOFT_DESCENT_GLSL
#include "shaders/lib/matter_sums.glsl"

uint at(uint vector, uint node) { return vector * args.nodeCount + node; }
bool isFree(uint node) { return args.nodes.at[kNodeVec4s * node + 1].w != 0; }

// The sum of a row over all blocks, and the maximum of its last component; for all invocations of a workgroup.
vec4 readRow(uint row) {
  vec4 sum = vec4(0), largest = vec4(0);
  for (uint block = gl_LocalInvocationIndex; block < args.blocks; block += kMatterBlock) {
    const vec4 its = args.sums.at[row * args.blocks + block];
    sum += its;
    largest.w = max(largest.w, its.w);
  }
  addUp(sum, largest, true);
  return vec4(sum.xyz, largest.w);
}

// Writes the entry of this block. All invocations call it together.
void keepRow(uint row, float term, float candidate) {
  vec4 sum = vec4(term, 0, 0, 0), largest = vec4(0, 0, 0, candidate);
  addUp(sum, largest, true);
  if (gl_LocalInvocationIndex == 0) args.sums.at[row * args.blocks + workgroupIndex()] = vec4(sum.xyz, largest.w);
}

// Step length of a trial along the search direction.
float trialScale() { return kTrialStrain * args.setting.now.spacing / sqrt(readRow(kLongestRow).w); }

#endif
