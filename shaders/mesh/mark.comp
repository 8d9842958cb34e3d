#version 460
#extension GL_GOOGLE_include_directive : require
// Marks the blocks that have a node within reach of a point: a one in the table. An invocation visits one row of blocks
// for one point, so that a lattice much finer than the cloud has no long loops.
#include "shaders/mesh/lattice.glsl"

void main() {
  const uint thread = threadIndex();
  const uint rowsOfPoint = args.rows * args.rows;
  const uint slot = thread / rowsOfPoint;
  if (slot >= args.count) return;
  const vec4 point = args.cloud.positions.at[slot];
  if (floatBitsToUint(point.w) == kEmptySlot) return;
  const uint row = thread % rowsOfPoint;
  const float side = float(kMeshBlockSide) * args.lattice.cell;
  const float reach = args.lattice.reach * 1.0001;  // rounding must not leave out a node
  const vec3 place = point.xyz - args.lattice.origin;
  const ivec3 low = lowestBlock(place, reach);
  const int y = low.y + int(row % args.rows), z = low.z + int(row / args.rows);
  if (y < 0 || z < 0 || y >= int(args.lattice.blocks.y) || z >= int(args.lattice.blocks.z)) return;
  Uints table = args.buffers.at[0].now.table;
  for (int x = max(low.x, 0); x < min(low.x + int(args.rows), int(args.lattice.blocks.x)); ++x) {
    const uvec3 block = uvec3(x, y, z);
    const vec3 first = vec3(block) * side, last = first + (side - args.lattice.cell);
    const vec3 away = place - clamp(place, first, last);
    if (dot(away, away) >= reach * reach) continue;
    const uint number = blockNumber(args.lattice, block);
    if (table.at[number] == 0) table.at[number] = 1;  // most points find it marked, and reading costs less than writing
  }
}
