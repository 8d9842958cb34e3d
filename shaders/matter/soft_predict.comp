#version 460
#extension GL_GOOGLE_include_directive : require
// Predicts the balls of tools for the end of the first substep of a step, before a soft body presses on them.
#include "shaders/lib/index.glsl"
#include "shaders/shared/soft_passes.h"

layout(push_constant, scalar) uniform Push { SoftPredictArgs args; };

#include "shaders/lib/matter_hands.glsl"

void main() {
  const uint tool = threadIndex();
  if (tool < args.toolCount) predictTool(tool, 0);
}
