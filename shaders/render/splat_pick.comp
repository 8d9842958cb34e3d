#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_EXT_control_flow_attributes : require
// Surface splatting in compute, pass 1: lists the visible splats, the small ones and the large ones with their tiles.
// The lists are in the order of arrival, on which no picture depends. Most points of a large cloud are not drawn, which
// their position and their lot show: a workgroup looks at those of several points for each invocation, whose reads are
// in flight together, and measures the discs of the others side by side.
#include "shaders/lib/subgroup_reduce.glsl"
#include "shaders/render/frame_block.glsl"
#include "shaders/render/shown.glsl"
#include "shaders/render/splat.glsl"

const uint kFullBlocks = 1u << 27;

// Points that may be drawn.
shared uint candidates[kPickPoints * gl_WorkGroupSize.x], candidateCount;
// Of a round of this workgroup, and their first indices in the lists: one addition to each global counter for all its
// invocations, since additions to one memory location are serialised.
shared uint smallsHere, largesHere, sharesHere;
shared uvec3 starts;
// Of each invocation: its point, and the first index of its shares among those of its subgroup.
shared uint points[gl_WorkGroupSize.x], subgroupStarts[gl_WorkGroupSize.x];

// The whole subgroup calls it together.
void listCandidates(bool wanted, uint point) {
  const uvec4 ballot = subgroupBallot(wanted);
  uint first = 0;
  if (subgroupElect()) first = atomicAdd(candidateCount, subgroupBallotBitCount(ballot));
  first = subgroupBroadcastFirst(first);
  if (wanted) candidates[first + subgroupBallotExclusiveBitCount(ballot)] = point;
}

// Lists the splats of one candidate for each invocation. The whole workgroup calls it together.
void listSplats(RenderView view, uint candidate) {
  const uint point = candidate < candidateCount ? candidates[candidate] : 0;
  Disc disc;
  bool seen = candidate < candidateCount && loadDisc(view, point, disc);
  PixelBox box = PixelBox(ivec2(0), ivec2(-1));
  if (seen) box = boxOf(view, disc);
  const ivec2 size = box.last - box.first + 1;
  seen = seen && all(greaterThan(size, ivec2(0)));
  const bool large = seen && size.x * size.y > int(kSmallSplat);
  const uvec2 tiles = large ? (uvec2(size) - 1) / uvec2(kTile) + 1 : uvec2(0);
  const uint shares = min(tiles.x * tiles.y, kMaxShares + 1);

  const uvec4 smalls = subgroupBallot(seen && !large), larges = subgroupBallot(large);
  uint sharesInAll;
  const uint sharesBefore = subgroupScan(shares, sharesInAll);
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
    // Beyond the lists' capacity numbers need only show that, and no sum may wrap.
    const uint most = kMaxShares + 1, before = args.counts.at[0].blocks;
    starts.z = most;
    if (before < kFullBlocks) {
      if (sharesHere > 0) atomicAdd(args.counts.at[0].blocks, (sharesHere + kSharesInBlock - 1) / kSharesInBlock);
      starts.z = sharesHere > 0 ? atomicAdd(args.counts.at[0].shares, min(sharesHere, most)) : 0;
    }
    smallsHere = largesHere = sharesHere = 0;
  }
  barrier();
  if (seen && !large) args.picked.at[starts.x + before.x + subgroupBallotExclusiveBitCount(smalls)] = point;
  const uint fromEnd = starts.y + before.y + subgroupBallotExclusiveBitCount(larges);
  if (large) args.picked.at[frame.count - 1 - fromEnd] = point;
  // Each invocation of the subgroup writes every gl_SubgroupSize-th share: one disc may have thousands.
  const uint first = starts.z + before.z;
  for (uint i = gl_SubgroupInvocationID; i < sharesInAll && first + i < kMaxShares; i += gl_SubgroupSize) {
    // The last disc whose shares begin at i or before; discs without shares begin where the next one does.
    uint owner = firstPlace;
    for (uint step = gl_SubgroupSize / 2; step > 0; step /= 2)
      if (subgroupStarts[owner + step] <= i) owner += step;
    args.shares.at[first + i] = uvec2(points[owner], i - subgroupStarts[owner]);
  }
}

void main() {
  if (gl_LocalInvocationIndex == 0) candidateCount = smallsHere = largesHere = sharesHere = 0;
  barrier();
  const RenderView view = frame.view;
  const uint first = workgroupIndex() * gl_WorkGroupSize.x * kPickPoints + gl_LocalInvocationIndex;
  const uint end = frame.count;
  vec3 positions[kPickPoints];
  [[unroll]] for (uint k = 0; k < kPickPoints; ++k) {
    const uint point = first + k * gl_WorkGroupSize.x;
    if (point < end) positions[k] = args.positions.at[point].xyz;
  }
  [[unroll]] for (uint k = 0; k < kPickPoints; ++k) {
    const uint point = first + k * gl_WorkGroupSize.x;
    listCandidates(point < end && mayBeDrawn(view, point, positions[k]) && isDisc(point), point);
  }
  barrier();
  // Every round but the last is full.
  for (uint done = 0; done < candidateCount; done += gl_WorkGroupSize.x)
    listSplats(view, done + gl_LocalInvocationIndex);
}
