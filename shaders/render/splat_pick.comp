#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_arithmetic : require
// Surface splatting in compute, pass 1: lists the splats that the picture shows, the small ones and the large ones with
// their tiles. The lists' order is that of arrival, and no picture depends on it.
#include "shaders/render/splat.glsl"

void main() {
  const RenderView view = args.frame.at[0].view;
  const uint point = threadIndex();
  Disc disc;
  bool seen = point < args.frame.at[0].count && loadDisc(view, point, disc);
  PixelBox box = PixelBox(ivec2(0), ivec2(-1));
  if (seen) box = splatBox(view, disc);
  const ivec2 size = box.last - box.first + 1;
  seen = seen && all(greaterThan(size, ivec2(0)));
  const bool large = seen && size.x * size.y > int(kSmallSplat);
  const uvec2 tiles = large ? (uvec2(size) - 1) / kSplatTile + 1 : uvec2(0);
  const uint shares = tiles.x * tiles.y;

  const uvec4 smalls = subgroupBallot(seen && !large), larges = subgroupBallot(large);
  const uint sharesBefore = subgroupExclusiveAdd(shares), sharesInAll = subgroupAdd(shares);
  uvec3 starts = uvec3(0);
  if (subgroupElect()) {
    if (any(notEqual(smalls, uvec4(0))))
      starts.x = atomicAdd(args.counts.at[0].small, subgroupBallotBitCount(smalls));
    if (sharesInAll > 0) {
      starts.y = atomicAdd(args.counts.at[0].large, subgroupBallotBitCount(larges));
      starts.z = atomicAdd(args.counts.at[0].shares, sharesInAll);
    }
  }
  starts = subgroupBroadcastFirst(starts);
  if (!seen) return;
  if (!large) {
    args.picked.at[starts.x + subgroupBallotExclusiveBitCount(smalls)] = point;
    return;
  }
  args.picked.at[args.frame.at[0].count - 1 - (starts.y + subgroupBallotExclusiveBitCount(larges))] = point;
  const uint first = starts.z + sharesBefore;
  for (uint tile = 0; tile < shares && first + tile < kMaxShares; ++tile)
    args.shares.at[first + tile] = uvec2(point, tile);
}
