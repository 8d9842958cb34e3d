#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_arithmetic : require
// Surface splatting in compute, pass 1: lists the splats that the picture shows, the small ones and the large ones with
// their tiles. The lists' order is that of arrival, and no picture depends on it.
#include "shaders/render/splat.glsl"

// Of this workgroup, and where they begin in the lists: one addition to each global counter for all of its invocations,
// since additions to one place of memory come one after the other.
shared uint smallsHere, largesHere, sharesHere;
shared uvec3 starts;
// Of each invocation: its point, and where its shares begin among those of its subgroup.
shared uint points[gl_WorkGroupSize.x], subgroupStarts[gl_WorkGroupSize.x];

void main() {
  if (gl_LocalInvocationIndex == 0) smallsHere = largesHere = sharesHere = 0;
  barrier();
  const RenderView view = args.frame.at[0].view;
  const uint point = threadIndex();
  Disc disc;
  bool seen = point < args.frame.at[0].count && loadDisc(view, point, disc);
  PixelBox box = PixelBox(ivec2(0), ivec2(-1));
  if (seen) box = splatBox(view, disc);
  const ivec2 size = box.last - box.first + 1;
  seen = seen && all(greaterThan(size, ivec2(0)));
  const bool large = seen && size.x * size.y > int(kSmallSplat);
  const uvec2 tiles = large ? (uvec2(size) - 1) / uvec2(kTile) + 1 : uvec2(0);
  const uint shares = tiles.x * tiles.y;

  const uvec4 smalls = subgroupBallot(seen && !large), larges = subgroupBallot(large);
  const uint sharesBefore = subgroupExclusiveAdd(shares), sharesInAll = subgroupAdd(shares);
  const uint firstPlace = gl_SubgroupID * gl_SubgroupSize;  // of this subgroup
  points[firstPlace + gl_SubgroupInvocationID] = point;
  subgroupStarts[firstPlace + gl_SubgroupInvocationID] = sharesBefore;
  uvec3 before = uvec3(0);  // subgroups of this workgroup
  if (subgroupElect())
    before = uvec3(atomicAdd(smallsHere, subgroupBallotBitCount(smalls)),
                   atomicAdd(largesHere, subgroupBallotBitCount(larges)), atomicAdd(sharesHere, sharesInAll));
  before = subgroupBroadcastFirst(before);
  barrier();
  if (gl_LocalInvocationIndex == 0) {
    starts.x = smallsHere > 0 ? atomicAdd(args.counts.at[0].small, smallsHere) : 0;
    starts.y = largesHere > 0 ? atomicAdd(args.counts.at[0].large, largesHere) : 0;
    starts.z = sharesHere > 0 ? atomicAdd(args.counts.at[0].shares, sharesHere) : 0;
  }
  barrier();
  if (seen && !large) args.picked.at[starts.x + before.x + subgroupBallotExclusiveBitCount(smalls)] = point;
  const uint fromEnd = starts.y + before.y + subgroupBallotExclusiveBitCount(larges);
  if (large) args.picked.at[args.frame.at[0].count - 1 - fromEnd] = point;
  // Each invocation of the subgroup writes every so-manyth share: one disc may have thousands.
  const uint first = starts.z + before.z;
  for (uint i = gl_SubgroupInvocationID; i < sharesInAll && first + i < kMaxShares; i += gl_SubgroupSize) {
    // The last disc whose shares begin at i or before; those without any begin where the next one does.
    uint owner = firstPlace;
    for (uint step = gl_SubgroupSize / 2; step > 0; step /= 2)
      if (subgroupStarts[owner + step] <= i) owner += step;
    args.shares.at[first + i] = uvec2(points[owner], i - subgroupStarts[owner]);
  }
}
