#version 460
#extension GL_GOOGLE_include_directive : require
// Points that an edit took away go to the log.
#include "shaders/lib/index.glsl"
#include "shaders/lib/edit_buffers.glsl"

layout(push_constant, scalar) uniform Push { LogGoneArgs args; };

void main() {
  if (args.update.at[0].failed != 0) return;
  const uint moves = args.update.at[0].moves;
  for (uint i = threadIndex(); i < moves; i += gl_NumWorkGroups.x * gl_WorkGroupSize.x) {
    if (args.moves.at[i].toBucket != kNoBucket) continue;
    const uint id = args.moves.at[i].id;
    const uint slot = atomicAdd(args.head.at[0], 1) & args.capacityMask;
    args.entries.at[slot].position = args.moves.at[i].position;
    args.entries.at[slot].id = id | kPointGone;
    args.entries.at[slot].normal = args.moves.at[i].normal;
    args.entries.at[slot].color = colorOf(args.colors, id);
    args.entries.at[slot].parent = parentOf(args.parents, args.firstNew, id);
  }
}
