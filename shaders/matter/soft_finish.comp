#version 460
#extension GL_GOOGLE_include_directive : require
// The end of a step of a soft body, one workgroup: the sums of all blocks.
#include "shaders/lib/index.glsl"
#include "shaders/shared/soft_passes.h"

layout(push_constant, scalar) uniform Push { SoftFinishArgs args; };

#include "shaders/lib/matter_sums.glsl"

void main() {
  vec4 onWalls, compressed, onPins, momentum;
  sumRows(args.cellSums, 0, args.cellBlocks, args.cellBlocks, true, onWalls, compressed);
  sumRows(args.nodeSums, 0, args.nodeBlocks, args.nodeBlocks, false, onPins, momentum);
  if (gl_LocalInvocationIndex != 0) return;
  args.total.now.onWalls = onWalls.xyz + onPins.xyz;
  args.total.now.kinetic = onPins.w;
  args.total.now.momentum = momentum.xyz;
  args.total.now.mostCompression = compressed.w;
}
