#version 460
#extension GL_GOOGLE_include_directive : require
// The box around the skin points to which the nodes of each block contribute.
#include "shaders/lib/index.glsl"
#include "shaders/shared/soft_press.h"

layout(push_constant, scalar) uniform Push { SoftReachArgs args; };

#include "shaders/lib/soft_boxes.glsl"

const float kFar = 3e38;

shared vec3 lows[kMatterBlock], highs[kMatterBlock];

void main() {
  const uint local = gl_LocalInvocationIndex, node = workgroupIndex() * kMatterBlock + local;
  vec3 low = vec3(kFar), high = vec3(-kFar);
  for (uint k = 0; node < args.nodeCount && k < 8; ++k) {
    const uint slot = slotAbout(node, k);
    if (slot >= args.skinCount) continue;
    low = min(low, args.boxes.at[kBoxVec4s * slot].xyz);
    high = max(high, args.boxes.at[kBoxVec4s * slot + 1].xyz);
  }
  lows[local] = low;
  highs[local] = high;
  for (uint left = kMatterBlock / 2; left > 0; left /= 2) {
    barrier();
    if (local >= left) continue;
    lows[local] = min(lows[local], lows[local + left]);
    highs[local] = max(highs[local], highs[local + left]);
  }
  if (local != 0) return;
  args.blockBoxes.at[kBoxVec4s * workgroupIndex()] = vec4(lows[0], 0);
  args.blockBoxes.at[kBoxVec4s * workgroupIndex() + 1] = vec4(highs[0], 0);
}
