#version 460
#extension GL_GOOGLE_include_directive : require
// What points wished for at the end of the last tick: those that go are taken away, a new point comes where no wish of
// a smaller id stands in its way, and all others are looked at again. Leaves to the brush what it moves or takes by
// itself. One subgroup for each wish.
#include "shaders/lib/index.glsl"
#include "shaders/lib/brush_reach.glsl"

layout(push_constant, scalar) uniform Push { RecallArgs args; };

// Whether no wish of a smaller id claims one of the cells about the place.
bool claimStands(HashGrid grid, vec3 place, uint id) {
  const uint kCellsAbout = 27;
  const ivec3 cell = cellOf(grid, place);
  bool stands = true;
  for (uint c = gl_SubgroupInvocationID; c < kCellsAbout; c += gl_SubgroupSize) {
    const ivec3 about = cell + ivec3(c % 3, c / 3 % 3, c / 9) - 1;
    if (args.lists.claims[bucketOf(grid, about)] < id) stands = false;
  }
  return subgroupAll(stands);
}

// Another part of the points in each tick.
bool isHeard(uint id) {
  const uint scattered = (id ^ args.lists.now.tick * 19349663u) * 2654435761u;
  return scattered >> 16 << args.lists.now.thinning < 65536u;
}

void main() {
  if (args.forgets == 0) takeUpBrush(args.brush, args.state);
  const HashGrid claims = claimGrid(args.brush.at[0].support / kSupportSpacings);
  const uint wishes = min(args.lists.now.wishes, args.mostMoves);
  const uint stride = gl_NumWorkGroups.x * gl_NumSubgroups;
  for (uint i = workgroupIndex() * gl_NumSubgroups + gl_SubgroupID; i < wishes; i += stride) {
    const uint id = args.lists.wishes[i].id;
    const uint slot = slotIn(args.cloud, bucketAt(args.cloud, args.lists.wishes[i].position), id);
    bool moves = false;
    PointMove move;
    if (slot != kEmptySlot) {
      const vec4 position = args.cloud.positions.at[slot];
      const vec4 normal = args.cloud.normals.at[slot];
      if (args.forgets != 0) {
        if (subgroupElect() && normal.w == kMarkGoes) args.cloud.normals.at[slot].w = 0.0;
      } else {
        PointMove unused;
        // A build may follow, and then the brush has been at work already.
        moves = subgroupElect() && normal.w != kMarkRefit &&
                !brushedMove(args.cloud, args.tables, slot, position, unused);
        move = stayingMove(args.cloud, slot, position, normal.xyz);
        if (normal.w == kMarkGoes) move.toBucket = kNoBucket;
      }
    }
    const uint at = nextMove(args.update, moves);
    if (moves) writeMove(args.update, args.moves, args.marks, args.touched, args.mostMoves, at, move);
    const bool inserts = args.forgets == 0 && args.lists.wishes[i].inserts != 0 && isHeard(id) &&
                         claimStands(claims, args.lists.wishes[i].place, id);
    if (inserts && subgroupElect()) {
      const uint birth = atomicAdd(args.lists.now.births, 1);
      if (birth < kMostBirths) args.lists.births[birth] = i;
    }
  }
}
