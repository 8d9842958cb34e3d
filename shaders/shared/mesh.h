#ifndef PALPATE_SHARED_MESH_H
#define PALPATE_SHARED_MESH_H
#include "shaders/shared/contact.h"
#include "shaders/shared/mesh_vertex.h"

#ifdef __cplusplus
#define precise
#endif

PALPATE_SHARED_BEGIN

// The lattice is kept in blocks of so many nodes a side; a block owns its nodes, the edges that begin at them and the
// cells whose lowest corner they are. Smaller blocks hug the surface and cost more visits of neighbouring ones.
const uint kMeshBlockSide = 8;
const uint kMeshBlockNodes = kMeshBlockSide * kMeshBlockSide * kMeshBlockSide;
// Nodes that a block's cells touch along an axis.
const uint kMeshApronSide = kMeshBlockSide + 1;
const uint kMeshApronNodes = kMeshApronSide * kMeshApronSide * kMeshApronSide;
// Which edges hold a vertex: four bits for each node, of which one for each axis is used.
const uint kMeshNodesPerWord = 8;
const uint kMeshMaskWords = kMeshBlockNodes / kMeshNodesPerWord;
// Cases of cells: a byte each.
const uint kMeshCellsPerWord = 4;
const uint kMeshCaseWords = kMeshBlockNodes / kMeshCellsPerWord;
// Invocations that work on one block together: one for each word of cases.
const uint kMeshWorkgroup = kMeshCaseWords;
// Invocations that sum together over the points for the nodes of a part of a block, and how many share those of one
// node. Sharers see fewer points in vain, and fetch more of them.
const uint kMeshFieldWorkgroup = 512;  // or 256, where a device has no wider ones
const uint kMeshFieldSharers = 2;
// The same for the vertices of a block.
const uint kMeshVertexWorkgroup = 256;
const uint kMeshVertexSharers = 2;

// The value of a node that no surface is known about. A number, since shaders may take not-a-number for one.
const float kMeshUndefined = 3.0e38f;
// A vertex stays this far from both ends of its edge, in edges, so that no triangle shrinks to nothing where the
// surface goes through a node. More dents the surface there, less makes thinner slivers.
const float kMeshClearance = 1.0f / 128;
// Besides the kSurface... of contact: the thesis's density (its equation 3.1).
const uint kSurfaceDensity = 3;
// The density of the surface, of that on an even plane.
const float kMeshIsoDensity = 0.5f;

// Candidates that one box of places visits; where its cells hold more it takes every so-manyth. Few enough that an
// invocation, which sums over them up to three times, stays below the 65,535 loop rounds after which one software
// driver stops a shader; several times what an even cloud needs.
const uint kMeshMostCandidates = 8192;

// Blocks are numbered x fastest; node (0, 0, 0) of block (0, 0, 0) is at `origin`.
struct MeshLattice {
  vec3 origin;         // model units
  float cell;          // edge of a cell, model units
  uvec3 blocks;        // along each axis
  float radius;        // support radius of the surface, model units
  float reach;         // how far from a point nodes are computed, model units; at least the radius
  float densityScale;  // 1 over the sum of the weights on an even plane
};
PALPATE_SIZE(MeshLattice, 40);

// The same bits in C++ and GLSL, whichever block asks.
PALPATE_FUNCTION vec3 nodePlace(MeshLattice lattice, uvec3 node) {
  precise vec3 place = lattice.origin + vec3(node) * lattice.cell;
  return place;
}

PALPATE_FUNCTION uint blockNumber(MeshLattice lattice, uvec3 block) {
  return (block.z * lattice.blocks.y + block.y) * lattice.blocks.x + block.x;
}
PALPATE_FUNCTION uint blockCount(MeshLattice lattice) { return lattice.blocks.x * lattice.blocks.y * lattice.blocks.z; }
PALPATE_FUNCTION uvec3 blockOfNumber(MeshLattice lattice, uint number) {
  const uint row = number / lattice.blocks.x;
  return uvec3(number % lattice.blocks.x, row % lattice.blocks.y, row / lattice.blocks.y);
}
// A node's or a cell's place in its block; and back.
PALPATE_FUNCTION uint inBlock(uvec3 local) { return (local.z * kMeshBlockSide + local.y) * kMeshBlockSide + local.x; }
PALPATE_FUNCTION uvec3 localOf(uint place) {
  return uvec3(place % kMeshBlockSide, place / kMeshBlockSide % kMeshBlockSide,
               place / (kMeshBlockSide * kMeshBlockSide));
}

// Corners of a cell and its edges are numbered as in engine/mesh/cell_table.hpp.
PALPATE_FUNCTION uint lowCornerOf(uint edge) {
  const uint axis = edge / 4u, u = (axis + 1u) % 3u, v = (axis + 2u) % 3u;
  return (edge & 1u) << u | (edge >> 1 & 1u) << v;
}
PALPATE_FUNCTION uvec3 cornerOffset(uint corner) { return uvec3(corner & 1u, corner >> 1 & 1u, corner >> 2 & 1u); }

#ifndef __cplusplus
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer MeshFloats { float at[]; };
#endif

// One state of the lattice and its mesh. A table of n blocks has n + 1 words: a block's slot, and the next one's is
// larger where the block is there. "Slots": blocks that are there, in the order of their numbers.
struct MeshState {
  PALPATE_ADDRESS(Uints) table;
  PALPATE_ADDRESS(MeshFloats) values;   // kMeshBlockNodes for each slot: negative inside, model units
  PALPATE_ADDRESS(Uints) vertexStarts;  // for each slot its first vertex; last, how many there are
  PALPATE_ADDRESS(MeshVertices) vertices;
};
PALPATE_SIZE(MeshState, 32);

// Everything that the passes read and write. `old`: the state before an update.
struct MeshBuffers {
  MeshState now;
  MeshState old;
  PALPATE_ADDRESS(Uints) blocks;          // number of the block in each slot
  PALPATE_ADDRESS(Uints) cases;           // kMeshCaseWords for each slot: bits of the inside corners; 0: nothing there
  PALPATE_ADDRESS(Uints) masks;           // kMeshMaskWords for each slot
  PALPATE_ADDRESS(Uints) ranks;           // for each word of masks the vertices before it in its block
  PALPATE_ADDRESS(Uints) triangleStarts;  // as vertexStarts
  PALPATE_ADDRESS(Uints) triangles;       // three vertices each, anticlockwise as seen from outside
  PALPATE_ADDRESS(UVec2s) cellCases;      // for each case fifteen edges of four bits, then how many triangles
  PALPATE_ADDRESS(Uints) touched;         // for each slot, not zero where an edit may have changed something
  PALPATE_ADDRESS(Uints) colors;          // RGBA8 by the points' ids
  PALPATE_ADDRESS(MeshMoves) moves;
};
PALPATE_SIZE(MeshBuffers, 144);

// A point that an edit has set, and where it was before; not a number where there was or is none.
struct MeshMove {
  vec3 from;
  vec3 to;
  vec3 normal;
  uint id;
  uint color;
};
PALPATE_SIZE(MeshMove, 44);

#ifndef __cplusplus
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer MeshMoves { MeshMove at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer MeshBuffersOf { MeshBuffers at[]; };
#endif

struct MeshArgs {
  CloudView cloud;
  MeshLattice lattice;
  PALPATE_ADDRESS(MeshBuffersOf) buffers;
  uint count;  // of what the pass treats
  uint slots;
  uint rows;    // blocks along each axis that one point reaches
  uint update;  // not zero: what is not touched comes from the old state
  uint first;   // block of a pass that treats `count` of them
  uint unused;
};
PALPATE_SIZE(MeshArgs, 128);

struct MeshMoveArgs {
  PALPATE_ADDRESS(Vec4s) positions;  // by id
  PALPATE_ADDRESS(Vec4s) normals;
  PALPATE_ADDRESS(Uints) colors;
  PALPATE_ADDRESS(MeshMoves) moves;
  uint count;
  uint colored;
};
PALPATE_SIZE(MeshMoveArgs, 40);

PALPATE_SHARED_END

#ifdef __cplusplus
#undef precise
#endif
#endif
