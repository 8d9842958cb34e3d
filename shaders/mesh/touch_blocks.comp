#version 460
#extension GL_GOOGLE_include_directive : require
// Marks the blocks that an edit may have changed: those with a node, an edge or a cell next to one within the support
// radius of a point's old or new position. An invocation visits one row of blocks for one such position.
#include "shaders/mesh/lattice.glsl"

void main() {
  const uint thread = threadIndex();
  const uint rowsOfPlace = args.rows * args.rows;
  const uint k = thread / (2 * rowsOfPlace);
  if (k >= args.count) return;
  const bool after = thread / rowsOfPlace % 2 == 1;
  const vec3 position = after ? args.buffers.at[0].moves.at[k].to : args.buffers.at[0].moves.at[k].from;
  if (floatBitsToUint(position.x) == 0x7fc00000u) return;
  const uint row = thread % rowsOfPlace;
  const float side = float(kMeshBlockSide) * args.lattice.cell;
  const float reach = args.lattice.radius * 1.0001 + args.lattice.cell;
  const vec3 place = position - args.lattice.origin;
  const ivec3 low = lowestBlock(place, reach) - 1;
  const int y = low.y + int(row % args.rows), z = low.z + int(row / args.rows);
  if (y < 0 || z < 0 || y >= int(args.lattice.blocks.y) || z >= int(args.lattice.blocks.z)) return;
  for (int x = max(low.x, 0); x < min(low.x + int(args.rows), int(args.lattice.blocks.x)); ++x) {
    const uvec3 block = uvec3(x, y, z);
    const vec3 first = vec3(block) * side, last = first + side;
    const vec3 away = place - clamp(place, first, last);
    if (dot(away, away) >= reach * reach) continue;
    const uint slot = slotOf(args.buffers.at[0].now.table, block);
    if (slot != kNoSlot) args.buffers.at[0].touched.at[slot] = 1;
  }
}
