#version 460
#extension GL_GOOGLE_include_directive : require
// The wishes of the last tick have been heard, unless the edit was not carried out: their claims are taken away. One
// workgroup.
#include "shaders/lib/index.glsl"
#include "shaders/lib/edit_buffers.glsl"

layout(push_constant, scalar) uniform Push { RecallArgs args; };

void main() {
  const uint wishes = min(args.lists.now.wishes, args.mostMoves);
  const bool heard = args.update.at[0].failed == 0;
  const HashGrid grid = claimGrid(args.brush.at[0].support / kSupportSpacings);
  for (uint i = gl_LocalInvocationIndex; heard && i < wishes; i += gl_WorkGroupSize.x)
    if (args.lists.wishes[i].inserts != 0)
      args.lists.claims[bucketOf(grid, cellOf(grid, args.lists.wishes[i].place))] = 0xffffffffu;
  barrier();
  if (gl_LocalInvocationIndex != 0) return;
  args.lists.now.births = 0;
  if (!heard) return;
  args.lists.now.wishes = 0;
  args.lists.now.wishGroups.x = 0;
}
