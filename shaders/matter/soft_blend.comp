#version 460
#extension GL_GOOGLE_include_directive : require
// For each node of a soft body, the mean gradient of the displacements in the cells around it, weighted by volume.
#include "shaders/lib/index.glsl"
#include "shaders/shared/soft_passes.h"

layout(push_constant, scalar) uniform Push { SoftBlendArgs args; };

void main() {
  const uint node = threadIndex();
  if (node >= args.nodeCount) return;
  const uvec4 low = args.incident.at[kIncidentUVec4s * node], high = args.incident.at[kIncidentUVec4s * node + 1];
  mat3 sum = mat3(0);
  float volume = 0;
  for (uint k = 0; k < 8; ++k) {
    const uint slot = (k < 4 ? low[k] : high[k - 4]) % args.stride;
    volume += args.volumes.at[slot];
    for (uint plane = 0; plane < kGradientPlanes; ++plane)
      sum[plane / 3][plane % 3] += args.gradients.at[plane * args.stride + slot];
  }
  for (uint column = 0; column < 3; ++column)
    args.nodeGradients.at[kGradientVec4s * node + column] = vec4(sum[column] / volume, 0);
}
