#version 460
#extension GL_GOOGLE_include_directive : require
// The places of the points that are marked as moved, so that what follows costs by their number and not by the cloud's.
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_ballot : require
#include "shaders/lib/contact_buffers.glsl"
#include "shaders/lib/index.glsl"
#include "shaders/shared/edit.h"

layout(push_constant, scalar) uniform Push { CollectMovedArgs args; };

void main() {
  const uint i = threadIndex();
  const bool moved = i < args.count && args.normals.at[min(i, args.count - 1)].w != 0.0;
  const uvec4 ballot = subgroupBallot(moved);
  const uint found = subgroupBallotBitCount(ballot);
  if (found == 0) return;
  uint first = 0;
  if (subgroupElect()) first = atomicAdd(args.movedCount.at[0], found);
  first = subgroupBroadcastFirst(first);
  if (moved) args.moved.at[first + subgroupBallotExclusiveBitCount(ballot)] = i;
}
