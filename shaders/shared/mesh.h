#ifndef PALPATE_SHARED_MESH_H
#define PALPATE_SHARED_MESH_H
#include "shaders/shared/contact.h"
#include "shaders/shared/mesh_vertex.h"

#ifdef __cplusplus
#define precise
#endif

PALPATE_SHARED_BEGIN

// The lattice is stored in blocks of kMeshBlockSide nodes a side; a block owns its nodes, the edges that begin at them
// and the cells whose lowest corner they are. Smaller blocks follow the surface more closely and cost more visits of
// neighbouring blocks.
const uint kMeshBlockSide = 8;
const uint kMeshBlockNodes = kMeshBlockSide * kMeshBlockSide * kMeshBlockSide;
// Nodes that a block's cells touch along an axis.
const uint kMeshApronSide = kMeshBlockSide + 1;
const uint kMeshApronNodes = kMeshApronSide * kMeshApronSide * kMeshApronSide;
// Edges that hold a vertex: four bits for each node, of which three are used, one for each axis.
const uint kMeshNodesPerWord = 8;
const uint kMeshMaskWords = kMeshBlockNodes / kMeshNodesPerWord;
// Cases of cells: one byte each.
const uint kMeshCellsPerWord = 4;
const uint kMeshCaseWords = kMeshBlockNodes / kMeshCellsPerWord;
// Invocations that work on one block together: one for each word of cases.
const uint kMeshWorkgroup = kMeshCaseWords;
// Invocations that together sum over the points for the nodes of a part of a block, and the number of them that share
// one node. Sharing visits fewer points out of reach, and loads more points.
const uint kMeshFieldWorkgroup = 512;  // or 256, if the device's limit is lower
const uint kMeshFieldSharers = 2;
// The same for the vertices of a block.
const uint kMeshVertexWorkgroup = 256;
const uint kMeshVertexSharers = 2;

// The value of a node without a known surface. A number, since shaders may treat a NaN as a number.
const float kMeshUndefined = 3.0e38f;
// Minimum distance of a vertex from both ends of its edge, in edges, so that no triangle shrinks to nothing where the
// surface passes through a node. More dents the surface there, less makes thinner slivers.
const float kMeshClearance = 1.0f / 128;
// Besides the kSurface... of contact: the thesis's density (its equation 3.1).
const uint kSurfaceDensity = 3;
// Density at the surface, relative to that on an even plane.
const float kMeshIsoDensity = 0.5f;

// Candidates that one box of positions visits; if its cells hold more they are subsampled. Few enough that an
// invocation, which sums over them up to three times, stays below the 65,535 loop iterations after which one software
// driver stops a shader; several times what an even cloud needs.
const uint kMeshMaxCandidates = 8192;

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

// Bitwise the same in C++ and GLSL, and for every block.
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
// Index of a node or a cell in its block; and back.
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

// One state of the lattice and its mesh. A table of n blocks has n + 1 words: a block's slot; the block is present if
// the next word is larger. "Slots" are the present blocks, in the order of their numbers.
struct MeshState {
  PALPATE_ADDRESS(Uints) table;
  PALPATE_ADDRESS(MeshFloats) values;   // kMeshBlockNodes for each slot: negative inside, model units
  PALPATE_ADDRESS(Uints) vertexStarts;  // first vertex of each slot; last, the number of vertices
  PALPATE_ADDRESS(MeshVertices) vertices;
};
PALPATE_SIZE(MeshState, 32);

// All buffers that the passes read and write. `old`: the state before an update.
struct MeshBuffers {
  MeshState now;
  MeshState old;
  PALPATE_ADDRESS(Uints) blocks;          // number of the block in each slot
  PALPATE_ADDRESS(Uints) cases;           // kMeshCaseWords for each slot: bits of the inside corners; 0: no surface
  PALPATE_ADDRESS(Uints) masks;           // kMeshMaskWords for each slot
  PALPATE_ADDRESS(Uints) ranks;           // for each word of masks, the vertices before it in its block
  PALPATE_ADDRESS(Uints) triangleStarts;  // like vertexStarts
  PALPATE_ADDRESS(Uints) triangles;       // three vertices each, anticlockwise as seen from outside
  PALPATE_ADDRESS(UVec2s) cellCases;      // for each case fifteen edges of four bits, then the number of triangles
  PALPATE_ADDRESS(Uints) touched;         // for each slot, not zero if an edit may have changed it
  PALPATE_ADDRESS(Uints) colors;          // RGBA8 by the points' ids
  PALPATE_ADDRESS(MeshMoves) moves;
};
PALPATE_SIZE(MeshBuffers, 144);

// A point that an edit has set, and its position before; NaN if it did not exist, or no longer does.
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
  uint count;  // of the elements that the pass processes
  uint slots;
  uint rows;    // blocks along each axis that one point reaches
  uint update;  // not zero: untouched blocks are copied from the old state
  uint first;   // block of a pass that processes `count` of them
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
