#version 460
#extension GL_GOOGLE_include_directive : require
// Surface splatting in compute, pass 2: the number of workgroups that walk the listed splats, and the resolution of the
// sums of their normals and colours. One invocation.
#include "shaders/lib/index.glsl"
#include "shaders/shared/render.h"

layout(push_constant, scalar) uniform Push { SplatPlanArgs args; };

// Rows of workgroups in one round.
uint rowsFor(uint splats, uint perGroup) {
  const uint perRow = args.turns * kSplatRow * perGroup;
  return splats / perRow + uint(splats % perRow != 0);
}

void main() {
  if (threadIndex() > 0) return;
  const uint shares = args.counts.at[0].shares;
  const bool isCrowd = shares > kMaxShares;
  const uint sharesOfEach = isCrowd ? max(kMaxShares / args.counts.at[0].large, 1) : 0;
  const uint larges = isCrowd ? args.counts.at[0].large * sharesOfEach : shares;
  const uint rows[2] = uint[2](rowsFor(args.counts.at[0].small, args.smallsPerGroup),
                               rowsFor(larges, args.largesPerGroup));
  // No sum may reach 2^31, even if all splats are in one sample.
  const uint each = 0x7FFFFFFFu / max(args.counts.at[0].small + args.counts.at[0].large, 1);
  args.counts.at[0].sumScale = float(min(1u << findMSB(each), kFinestSum));
  args.counts.at[0].sharesOfEach = sharesOfEach;
  args.counts.at[0].shrunk =
      isCrowd ? min(sqrt(float(kMaxShares) / (float(kSharesInBlock) * float(args.counts.at[0].blocks))), 1) : 1;
  args.counts.at[0].smallGroups = uint[3](kSplatRow, rows[0], 1);
  args.counts.at[0].largeGroups = uint[3](kSplatRow, rows[1], 1);
}
