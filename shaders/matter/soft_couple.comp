#version 460
#extension GL_GOOGLE_include_directive : require
// Coupling of the positions of two presses, by the nodes that both hold.
#include "shaders/lib/index.glsl"
#include "shaders/shared/soft_press.h"

layout(push_constant, scalar) uniform Push { SoftCoupleArgs args; };

#include "shaders/lib/matter_sums.glsl"

// Share of a node in a press; 0 if the press does not hold it.
float shareIn(uint press, uint node) {
  const uint row = args.presses.at[press].row;
  uint low = row * args.heldStride, high = low + args.counts.at[1 + row];
  const uint end = high;
  while (low < high) {
    const uint middle = (low + high) / 2;
    if (args.held.at[middle].node < node)
      low = middle + 1;
    else
      high = middle;
  }
  return low < end && args.held.at[low].node == node ? args.held.at[low].share : 0;
}

void main() {
  const uint press = workgroupIndex(), presses = args.counts.at[0];
  if (press >= presses) return;
  const uint row = args.presses.at[press].row, held = args.counts.at[1 + row];
  for (uint other = 0; other < presses; ++other) {
    vec4 sum = vec4(0), none = vec4(0);
    for (uint k = gl_LocalInvocationIndex; k < held; k += kMatterBlock) {
      const uint at = row * args.heldStride + k, node = args.held.at[at].node;
      if (args.nodes.at[kNodeVec4s * node + 1].w == 0) continue;
      const float share = args.held.at[at].share;
      const float others = other == press ? share : shareIn(other, node);
      sum.x += share * (others / args.nodes.at[kNodeVec4s * node].w);
    }
    addUp(sum, none, false);
    if (gl_LocalInvocationIndex == 0) args.coupling.at[press * kMaxPresses + other] = sum.x;
  }
}
