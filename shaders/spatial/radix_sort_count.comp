#version 460
#extension GL_GOOGLE_include_directive : require
// LSD radix sort, pass 1 of 3: the number of keys of each digit in a partition.
#include "shaders/shared/radix_sort.h"
#include "shaders/lib/index.glsl"

layout(push_constant, scalar) uniform Push { RadixSortArgs args; };

shared uint histogram[kSortRadix];

void main() {
  const uint part = workgroupIndex();
  if (part >= args.partitions) return;
  const uint radix = 1u << args.digitBits;
  for (uint d = gl_LocalInvocationIndex; d < radix; d += gl_WorkGroupSize.x) histogram[d] = 0;
  barrier();
  const uint first = part * gl_WorkGroupSize.x * kSortItems;
  for (uint item = 0; item < kSortItems; ++item) {
    const uint i = first + item * gl_WorkGroupSize.x + gl_LocalInvocationIndex;
    if (i < args.count) atomicAdd(histogram[(args.keysIn.at[i] >> args.shift) & (radix - 1)], 1);
  }
  barrier();
  for (uint d = gl_LocalInvocationIndex; d < radix; d += gl_WorkGroupSize.x)
    args.counts.at[d * args.partitions + part] = histogram[d];
}
