#version 460
#extension GL_GOOGLE_include_directive : require
// New points get their ids, in the order of the ids that wished for them, so that the same edits give the same ids. One
// workgroup.
#include "shaders/lib/index.glsl"
#include "shaders/lib/edit_buffers.glsl"

layout(push_constant, scalar) uniform Push { BirthArgs args; };

shared uint wishers[kMostBirths];

void main() {
  const uint wished = args.lists.now.births;
  const uint births = wished > kMostBirths ? 0 : wished;
  const uint next = args.lists.now.nextId;
  for (uint i = gl_LocalInvocationIndex; i < births; i += gl_WorkGroupSize.x)
    wishers[i] = args.lists.wishes[args.lists.births[i]].id;
  barrier();
  const uint firstNew = args.tables.at[0].firstNew;
  for (uint base = 0; base < births; base += gl_WorkGroupSize.x) {
    const uint i = base + gl_LocalInvocationIndex;
    bool comes = i < births;
    uint id = next;
    if (comes) {
      const uint wisher = wishers[i];
      for (uint other = 0; other < births; ++other) id += wishers[other] < wisher ? 1 : 0;
      comes = id < args.tables.at[0].ids;
    }
    const uint at = nextMove(args.update, comes);
    if (comes) {
      const uint wish = args.lists.births[i];
      const vec3 place = args.lists.wishes[wish].place;
      if (!isNull(args.tables.at[0].colors)) args.tables.at[0].colors.at[id] = args.lists.wishes[wish].color;
      args.tables.at[0].parents.at[id - firstNew] = args.lists.wishes[wish].parent;
      const PointMove move = PointMove(place, id, args.lists.wishes[wish].normal, kMarkRefit, kEmptySlot, kNoBucket,
                                       bucketOf(args.grid, cellOf(args.grid, place)));
      writeMove(args.update, args.moves, args.marks, args.touched, args.mostMoves, at, move);
    }
  }
  barrier();
  if (gl_LocalInvocationIndex != 0) return;
  args.lists.now.nextId = min(next + births, args.tables.at[0].ids);
  args.lists.now.tick += 1;
  const uint thinning = args.lists.now.thinning;
  args.lists.now.thinning = wished > kMostBirths ? min(thinning + 1, 15) : thinning - min(thinning, 1);
}
