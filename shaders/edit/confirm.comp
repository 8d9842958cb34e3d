#version 460
#extension GL_GOOGLE_include_directive : require
// After all wishes of a tick: whoever has the least id that wants a cell of the claims says where it wants its point.
#include "shaders/lib/index.glsl"
#include "shaders/lib/edit_buffers.glsl"

layout(push_constant, scalar) uniform Push { RecallArgs args; };

void main() {
  const uint wishes = min(args.lists.now.wishes, args.mostMoves);
  const HashGrid grid = claimGrid(args.brush.at[0].support / kSupportSpacings);
  for (uint i = threadIndex(); i < wishes; i += gl_NumWorkGroups.x * gl_WorkGroupSize.x) {
    if (args.lists.wishes[i].inserts == 0) continue;
    const vec3 place = args.lists.wishes[i].place;
    const uint claim = bucketOf(grid, cellOf(grid, place));
    if (args.lists.claims[claim] == args.lists.wishes[i].id) args.lists.claimed[claim] = place;
  }
}
