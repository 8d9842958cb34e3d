#version 460
#extension GL_GOOGLE_include_directive : require
// The triangles of every cell, by the numbers of their vertices. One workgroup for each block, one invocation for the
// cells of one word.
#include "shaders/lib/workgroup_scan.glsl"
#include "shaders/mesh/lattice.glsl"

// The number of the vertex on an edge of a cell of the whole lattice.
uint vertexOn(uvec3 cell, uint edge) {
  const NodeSlot at = nodeSlot(args.buffers.at[0].now.table, cell + cornerOffset(lowCornerOf(edge)));
  const uint word = at.slot * kMeshMaskWords + at.place / kMeshNodesPerWord;
  const uint before = (1u << (at.place % kMeshNodesPerWord * 4 + edge / 4)) - 1;
  return args.buffers.at[0].now.vertexStarts.at[at.slot] + args.buffers.at[0].ranks.at[word] +
         bitCount(args.buffers.at[0].masks.at[word] & before);
}

void main() {
  const uint slot = workgroupIndex();
  if (slot >= args.slots) return;
  const uint lane = scanIndex();
  const uint word = args.buffers.at[0].cases.at[slot * kMeshCaseWords + lane];
  uint own = 0;
  for (uint k = 0; k < kMeshCellsPerWord; ++k) own += args.buffers.at[0].cellCases.at[word >> (8 * k) & 255].y >> 28;
  uint total;
  uint triangle = args.buffers.at[0].triangleStarts.at[slot] + workgroupExclusiveScan(own, total);
  if (own == 0) return;
  const uvec3 block = blockOfNumber(args.lattice, args.buffers.at[0].blocks.at[slot]);
  Uints triangles = args.buffers.at[0].triangles;
  for (uint k = 0; k < kMeshCellsPerWord; ++k) {
    const uvec2 edges = args.buffers.at[0].cellCases.at[word >> (8 * k) & 255];
    const uvec3 cell = block * kMeshBlockSide + localOf(lane * kMeshCellsPerWord + k);
    const uint corners = 3 * (edges.y >> 28);
    for (uint c = 0; c < corners; ++c) {
      const uint edge = (c < 8 ? edges.x >> (4 * c) : edges.y >> (4 * (c - 8))) & 15;
      triangles.at[3 * triangle + c] = vertexOn(cell, edge);
    }
    triangle += edges.y >> 28;
  }
}
