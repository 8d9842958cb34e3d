#version 460
#extension GL_GOOGLE_include_directive : require
// Gradient of the displacements in each cell of a soft body, weighted by its volume.
#include "shaders/lib/index.glsl"
#include "shaders/shared/soft_passes.h"

layout(push_constant, scalar) uniform Push { SoftStrainArgs args; };

#include "shaders/lib/soft_cells.glsl"

void main() {
  const uint slot = threadIndex();
  if (!holdsCell(slot)) return;
  Corners modes = displacementsOf(slot);
  takeModes(modes);
  const mat3 gradient = args.volumes.at[slot] * gradientOf(softRules(), modes);
  for (uint k = 0; k < kGradientPlanes; ++k) args.gradients.at[k * args.stride + slot] = gradient[k / 3][k % 3];
}
