#version 460
#extension GL_GOOGLE_include_directive : require
// The box around the skin points of each cell of a soft body: between the cell's corners, and a little beyond.
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
