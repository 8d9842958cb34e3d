#version 460
#extension GL_GOOGLE_include_directive : require
// Moves the nodes of a soft body by the forces of the cells around them (symplectic Euler). If there are tools, the
// first workgroup applies the forces of the cells to them, and predicts them for the next substep.
#include "shaders/lib/index.glsl"
#include "shaders/shared/soft_passes.h"

layout(push_constant, scalar) uniform Push { SoftNodesArgs args; };

#include "shaders/lib/matter_hands.glsl"
#include "shaders/lib/matter_sums.glsl"
#include "shaders/lib/soft_forces.glsl"

void moveTools() {
  for (uint tool = 0; tool < args.toolCount; ++tool) {
    vec4 impulse, angular;
    sumRows(args.cellSums, kSoftRowsOfAll + 2 * tool, args.cellBlocks, args.skinBlocks, false, impulse, angular);
    if (gl_LocalInvocationIndex != 0) continue;
    reactTool(tool, impulse.xyz, angular.xyz);
    if (args.ends == 0) predictTool(tool, args.substep + 1);
  }
}

// Sums over the block; all invocations of the workgroup call it together.
void keepSums(uint block, vec3 onPins, vec3 momentum, float kinetic) {
  vec4 a = vec4(onPins, kinetic), b = vec4(momentum, 0);
  addUp(a, b, false);
  if (gl_LocalInvocationIndex != 0) return;
  if (args.substep != 0 && args.hasPins != 0) a.xyz += args.sums.at[block].xyz;
  args.sums.at[block] = a;
  args.sums.at[args.blocks + block] = b;
}

void main() {
  const uint ahead = args.toolCount > 0 ? 1 : 0;
  if (workgroupIndex() < ahead) {
    moveTools();
    return;
  }
  const uint block = workgroupIndex() - ahead, node = block * kMatterBlock + gl_LocalInvocationIndex;
  const float step = args.setting.now.step;
  vec3 onPins = vec3(0), momentum = vec3(0);
  float kinetic = 0;
  if (node < args.nodeCount) {
    const vec4 moved = args.nodes.at[kNodeVec4s * node], before = args.nodes.at[kNodeVec4s * node + 1];
    const vec3 force = forceOn(node);
    if (before.w != 0) {
      const vec3 velocity = before.xyz + (step / moved.w * force + args.setting.now.fall);
      args.nodes.at[kNodeVec4s * node] = vec4(moved.xyz + step * velocity, moved.w);
      args.nodes.at[kNodeVec4s * node + 1] = vec4(velocity, before.w);
      momentum = moved.w * velocity;
      kinetic = moved.w / 2 * dot(velocity, velocity);
    } else {
      onPins = step * force;
    }
  }
  if (args.hasPins != 0 || args.ends != 0) keepSums(block, onPins, momentum, kinetic);
}
