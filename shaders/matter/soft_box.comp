#version 460
#extension GL_GOOGLE_include_directive : require
// Where the places of the skin are that each cell of a soft body has: between its corners, and a little beyond.
#include "shaders/lib/index.glsl"
#include "shaders/shared/soft_press.h"

layout(push_constant, scalar) uniform Push { SoftBoxArgs args; };

#include "shaders/lib/soft_cells.glsl"

void main() {
  const uint slot = threadIndex();
  if (slot >= args.skinCount) return;
  vec3 low, high;
  boxOf(args.skinCells.at[slot].corner, displacementsOf(slot), low, high);
  args.boxes.at[kBoxVec4s * slot] = vec4(low, 0);
  args.boxes.at[kBoxVec4s * slot + 1] = vec4(high, 0);
}
