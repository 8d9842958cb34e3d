// Common parts of the passes over the lattice: their arguments, and the lookup of blocks.
#ifndef PALPATE_MESH_LATTICE_GLSL
#define PALPATE_MESH_LATTICE_GLSL

#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require

// Declared before the structs that hold their addresses.
layout(buffer_reference) buffer MeshMoves;
layout(buffer_reference) buffer MeshBuffersOf;

#include "shaders/lib/contact_buffers.glsl"
#include "shaders/lib/index.glsl"
#include "shaders/shared/mesh.h"

layout(push_constant, scalar) uniform Push { MeshArgs args; };

const uint kNoSlot = 0xffffffffu;

// The slot of a block, or kNoSlot, also for a block beyond the lattice.
uint slotOf(Uints table, uvec3 block) {
  if (any(greaterThanEqual(block, args.lattice.blocks))) return kNoSlot;
  const uint number = blockNumber(args.lattice, block);
  const uint slot = table.at[number];
  return table.at[number + 1] > slot ? slot : kNoSlot;
}

// A node of the whole lattice, or an edge that begins there.
struct NodeSlot {
  uint slot;
  uint place;  // index in its block
};
NodeSlot nodeSlot(Uints table, uvec3 node) {
  return NodeSlot(slotOf(table, node / kMeshBlockSide), inBlock(node % kMeshBlockSide));
}

// The lowest block that a box of `reach` around a position (model units from the lattice's origin) may intersect. For a
// position beyond the lattice it is beyond it, too.
ivec3 lowestBlock(vec3 place, float reach) {
  const float side = float(kMeshBlockSide) * args.lattice.cell;
  return ivec3(floor(clamp((place - reach) / side, vec3(-2.0), vec3(args.lattice.blocks))));
}

// Index of the last entry that is not above `value`, in a list that begins with 0 and never falls.
uint lastNotAbove(Uints list, uint first, uint count, uint value) {
  uint low = 0, high = count;  // the answer is in [low, high)
  while (high - low > 1) {
    const uint middle = (low + high) / 2;
    if (list.at[first + middle] <= value) low = middle;
    else high = middle;
  }
  return low;
}

#endif
