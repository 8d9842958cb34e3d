#version 460
#extension GL_GOOGLE_include_directive : require
// Look-back radix sort: how many keys there are of every digit of every pass, in one reading.
#include "shaders/shared/look_back_sort.h"
#include "shaders/lib/index.glsl"
#include "shaders/lib/radix_digits.glsl"

layout(push_constant, scalar) uniform Push { RadixHistogramArgs args; };

shared uint histogram[kSortMaxPasses * kSortRadix];

void main() {
  const uint first = workgroupIndex() * gl_WorkGroupSize.x * kSweepHistogramItems;
  if (first >= args.count) return;
  for (uint d = gl_LocalInvocationIndex; d < args.passes * kSortRadix; d += gl_WorkGroupSize.x) histogram[d] = 0;
  barrier();
  for (uint item = 0; item < kSweepHistogramItems; ++item) {
    const uint i = first + item * gl_WorkGroupSize.x + gl_LocalInvocationIndex;
    if (i >= args.count) continue;
    const uint key = args.keys.at[i];
    for (uint pass = 0; pass < args.passes; ++pass) {
      const uvec2 digit = digitOfPass(args.keyBits, args.passes, pass);
      atomicAdd(histogram[pass * kSortRadix + bitfieldExtract(key, int(digit.x), int(digit.y))], 1);
    }
  }
  barrier();
  for (uint d = gl_LocalInvocationIndex; d < args.passes * kSortRadix; d += gl_WorkGroupSize.x)
    if (histogram[d] != 0) atomicAdd(args.histograms.at[d], histogram[d]);
}
