#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// The end of a substep, one workgroup: the sums of all blocks, what they do to the tools, and how the simulation is.
#include "shaders/lib/index.glsl"
#include "shaders/shared/matter_passes.h"

layout(push_constant, scalar) uniform Push { MatterFinishArgs args; };

#include "shaders/lib/matter_setting.glsl"
#include "shaders/lib/matter_sums.glsl"

const uint kAtOnce = 8;

// Both rows from `row` on, over all blocks.
void sumRows(uint row, bool keepsLargest, out vec4 a, out vec4 b) {
  a = b = vec4(0);
  for (uint begin = gl_LocalInvocationIndex; begin < args.blocks; begin += kAtOnce * kMatterBlock) {
    vec4 as[kAtOnce], bs[kAtOnce];  // all of them are asked for before the first one is waited for
    [[unroll]] for (uint k = 0; k < kAtOnce; ++k) {
      const uint block = min(begin + k * kMatterBlock, args.blocks - 1);
      as[k] = args.sums.at[row * args.blocks + block];
      bs[k] = args.sums.at[(row + 1) * args.blocks + block];
    }
    [[unroll]] for (uint k = 0; k < kAtOnce; ++k) {
      if (begin + k * kMatterBlock >= args.blocks) continue;
      a = combined(a, as[k], false);
      b = combined(b, bs[k], keepsLargest);
    }
  }
  addUp(a, b, keepsLargest);
}

void react(uint t, vec3 impulse, vec3 angular) {
  const vec3 change = impulse / SETTING.spring.mass;
  args.tools.at[t].velocity += change;
  args.tools.at[t].lag += SETTING.step * change;
  args.tools.at[t].impulse += impulse;
  args.tools.at[t].angular += angular;
}

void main() {
  if (args.control.now.state != kMatterRunning) return;
  const bool first = gl_LocalInvocationIndex == 0;
  const bool runs = isRunning(), stale = needsLists();
  const bool diverges = args.control.now.farthest >= kNotFinite;
  barrier();  // from here on one invocation changes what all have read
  if (!runs) {
    if (first) args.control.now.state = diverges ? kMatterDiverged : kMatterCrowded;
    if (first && args.substep == 0) args.control.now.substeps = 0;
    if (first && args.substep == 0) args.total.now.onWalls = vec3(0);
    return;
  }
  vec4 onWalls, momentum;
  sumRows(0, true, onWalls, momentum);
  for (uint tool = 0; tool < args.toolCount; ++tool) {
    vec4 impulse, angular;
    sumRows(kRowsOfAll + 2 * tool, false, impulse, angular);
    if (first) react(tool, impulse.xyz, angular.xyz);
  }
  if (!first) return;
  args.total.now.onWalls = (args.substep == 0 ? vec3(0) : args.total.now.onWalls) + onWalls.xyz;
  args.total.now.kinetic = onWalls.w;
  args.total.now.momentum = momentum.xyz;
  args.total.now.mostCompression = momentum.w;
  args.control.now.parity = 1 - args.control.now.parity;
  if (stale && args.makesLists != 0) args.control.now.lists += 1;
  if (stale && args.makesLists == 0) args.control.now.late += 1;
  args.control.now.farthest = 0;
  args.control.now.substeps = args.substep + 1;
  if (!(onWalls.w <= SETTING.mostKinetic)) args.control.now.state = kMatterDiverged;
}
