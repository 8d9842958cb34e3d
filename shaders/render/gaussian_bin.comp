#version 460
#extension GL_GOOGLE_include_directive : require
// Lists each Gaussian, by its rank in the order of depth, in the bins that it touches.
#include "shaders/lib/index.glsl"
#include "shaders/shared/gaussians.h"

layout(push_constant, scalar) uniform Push { GaussianBinArgs args; };

void main() {
  const uint rank = threadIndex();
  if (rank >= args.count || args.keys.at[rank] == kNotProjected) return;
  const uint gaussian = args.order.at[rank];
  const vec2 center = args.projected.at[gaussian].center_px, reach = args.projected.at[gaussian].reach_px;
  args.boxes.at[2 * rank] = vec4(center, reach);
  args.boxes.at[2 * rank + 1] =
      vec4(args.projected.at[gaussian].shape, squaredReach(args.projected.at[gaussian].opacity));
  const vec2 last = vec2(args.binsAcross, args.binsDown) - 1;
  const uvec2 from = uvec2(clamp(floor((center - reach) / float(args.binSide_px)), vec2(0), last));
  const uvec2 to = uvec2(clamp(floor((center + reach) / float(args.binSide_px)), vec2(0), last));
  for (uint y = from.y; y <= to.y; ++y)
    for (uint x = from.x; x <= to.x; ++x)
      atomicOr(args.bins.at[(y * args.binsAcross + x) * args.words + rank / 32], 1u << rank % 32);
}
