#version 460
#extension GL_GOOGLE_include_directive : require
// Look-back radix sort: the number of keys of every digit of every pass, in one read. The atomics in shared memory cost
// more than the read, so a workgroup keeps several copies side by side: neighbouring invocations count in different
// banks, and equal digits seldom meet in one word.
#extension GL_EXT_control_flow_attributes : require
#include "shaders/shared/look_back_sort.h"
#include "shaders/lib/index.glsl"
#include "shaders/lib/radix_digits.glsl"

layout(constant_id = 1) const uint kKeyBits = 21;
layout(constant_id = 2) const uint kPasses = 3;
layout(constant_id = 3) const uint kMaxBits = 7;  // of a digit
layout(constant_id = 4) const uint kCopies = 16;   // a power of two

layout(push_constant, scalar) uniform Push { RadixHistogramArgs args; };

const uint kRadix = 1u << kMaxBits;
const uint kBins = kPasses * kRadix;
// Keys of an invocation in flight at once. More take registers, and then fewer workgroups run concurrently.
const uint kTogether = 8;

shared uint histogram[kBins * kCopies];  // [pass][digit][copy]

void main() {
  const uint t = gl_LocalInvocationIndex;
  const uint copy = t & (kCopies - 1);
  for (uint i = t; i < kBins * kCopies; i += gl_WorkGroupSize.x) histogram[i] = 0;
  barrier();
  const uint first = workgroupIndex() * gl_WorkGroupSize.x * kSweepHistogramItems + t;
  [[dont_unroll]] for (uint done = 0; done < kSweepHistogramItems; done += kTogether) {
    uint keys[kTogether];
    [[unroll]] for (uint item = 0; item < kTogether; ++item) {
      const uint i = first + (done + item) * gl_WorkGroupSize.x;
      if (i < args.count) keys[item] = args.keys.at[i];
    }
    [[unroll]] for (uint item = 0; item < kTogether; ++item) {
      if (first + (done + item) * gl_WorkGroupSize.x >= args.count) continue;
      [[unroll]] for (uint pass = 0; pass < kPasses; ++pass) {
        const uvec2 digit = digitOfPass(kKeyBits, kPasses, pass);
        const uint bin = pass * kRadix + bitfieldExtract(keys[item], int(digit.x), int(digit.y));
        atomicAdd(histogram[bin * kCopies + copy], 1);
      }
    }
  }
  barrier();
  for (uint bin = t; bin < kBins; bin += gl_WorkGroupSize.x) {
    uint sum = 0;
    // Neighbours begin with different copies, to avoid bank conflicts.
    for (uint c = 0; c < kCopies; ++c) sum += histogram[bin * kCopies + ((c + bin) & (kCopies - 1))];
    if (sum != 0) atomicAdd(args.histograms.at[bin / kRadix * kSortRadix + bin % kRadix], sum);
  }
}
