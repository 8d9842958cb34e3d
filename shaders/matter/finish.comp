#version 460
#extension GL_GOOGLE_include_directive : require
// The end of a substep, one workgroup: the sums of all blocks, their effect on the tools, and the simulation's state.
#include "shaders/lib/index.glsl"
#include "shaders/shared/matter_passes.h"

layout(push_constant, scalar) uniform Push { MatterFinishArgs args; };

#include "shaders/lib/matter_setting.glsl"
#include "shaders/lib/matter_sums.glsl"
#include "shaders/lib/matter_tools.glsl"

void main() {
  if (args.control.now.state != kMatterRunning) return;
  const bool first = gl_LocalInvocationIndex == 0;
  const bool runs = isRunning(), stale = needsLists();
  const bool diverges = args.control.now.farthest >= kNotFinite;
  barrier();  // from here on one invocation changes what all have read
  if (!runs) {
    if (first) args.control.now.state = diverges ? kMatterDiverged : kMatterCrowded;
    if (first && args.substep == 0) args.control.now.substeps = 0;
    if (first && args.substep == 0)
      args.total.now.onWalls = args.total.now.onModel = args.total.now.turnOfModel = vec3(0);
    return;
  }
  vec4 onWalls, momentum;
  sumRows(args.sums, 0, args.blocks, args.blocks, true, onWalls, momentum);
  for (uint tool = 0; tool < args.toolCount; ++tool) {
    vec4 impulse, angular;
    sumRows(args.sums, kRowsOfAll + 2 * tool, args.blocks, args.blocks, false, impulse, angular);
    if (first) reactTool(tool, impulse.xyz, angular.xyz);
  }
  vec4 onModel = vec4(0), turnOfModel = vec4(0);
  if (SETTING.model.nodes.x > 0)
    sumRows(args.sums, kRowsOfAll + 2 * args.toolCount, args.blocks, args.blocks, false, onModel, turnOfModel);
  if (!first) return;
  args.total.now.onWalls = (args.substep == 0 ? vec3(0) : args.total.now.onWalls) + onWalls.xyz;
  args.total.now.onModel = (args.substep == 0 ? vec3(0) : args.total.now.onModel) + onModel.xyz;
  args.total.now.turnOfModel = (args.substep == 0 ? vec3(0) : args.total.now.turnOfModel) + turnOfModel.xyz;
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
