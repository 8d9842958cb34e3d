#version 460
#extension GL_GOOGLE_include_directive : require
// The inside corners of every cell, the number of triangles of each block, and the edges that hold a vertex. One
// workgroup for each block, one invocation for the cells of one word. A node with value zero is outside. A cell with an
// undefined node is empty: there the surface has its border.
#include "shaders/mesh/lattice.glsl"

shared uint neighbourSlots[8];
shared float nodes[kMeshApronNodes];
shared uint ownMasks[kMeshMaskWords];
shared uint triangles;

void loadApron(uvec3 block) {
  const uint lane = gl_LocalInvocationIndex;
  if (lane < 8) neighbourSlots[lane] = slotOf(args.buffers.at[0].now.table, block + cornerOffset(lane));
  if (lane < kMeshMaskWords) ownMasks[lane] = 0;
  if (lane == 0) triangles = 0;
  barrier();
  MeshFloats values = args.buffers.at[0].now.values;
  for (uint i = lane; i < kMeshApronNodes; i += kMeshWorkgroup) {
    const uvec3 at = uvec3(i % kMeshApronSide, i / kMeshApronSide % kMeshApronSide,
                           i / (kMeshApronSide * kMeshApronSide));
    const uvec3 beyond = at / kMeshBlockSide;
    const uint slot = neighbourSlots[beyond.x | beyond.y << 1 | beyond.z << 2];
    nodes[i] = slot == kNoSlot ? kMeshUndefined : values.at[slot * kMeshBlockNodes + inBlock(at % kMeshBlockSide)];
  }
  barrier();
}

// The bits of the inside corners; 0 if the cell is empty, 255 if it is all inside.
uint caseOf(uvec3 cell) {
  uint inside = 0;
  bool known = true;
  for (uint corner = 0; corner < 8; ++corner) {
    const uvec3 at = cell + cornerOffset(corner);
    const float value = nodes[(at.z * kMeshApronSide + at.y) * kMeshApronSide + at.x];
    known = known && value < kMeshUndefined;
    inside |= value < 0.0 ? 1u << corner : 0u;
  }
  return known ? inside : 0;
}

void noteVertices(uvec3 cell, uint inside) {
  for (uint edge = 0; edge < 12; ++edge) {
    const uint low = lowCornerOf(edge), axis = edge / 4, high = low | 1u << axis;
    if (((inside >> low ^ inside >> high) & 1) == 0) continue;
    const uvec3 at = cell + cornerOffset(low);
    const uvec3 beyond = at / kMeshBlockSide;
    const uint slot = neighbourSlots[beyond.x | beyond.y << 1 | beyond.z << 2];
    const uint node = inBlock(at % kMeshBlockSide);
    const uint bit = 1u << (node % kMeshNodesPerWord * 4 + axis);
    if (beyond == uvec3(0)) atomicOr(ownMasks[node / kMeshNodesPerWord], bit);
    else atomicOr(args.buffers.at[0].masks.at[slot * kMeshMaskWords + node / kMeshNodesPerWord], bit);
  }
}

void main() {
  const uint slot = workgroupIndex();
  if (slot >= args.slots) return;
  const uint lane = gl_LocalInvocationIndex;
  loadApron(blockOfNumber(args.lattice, args.buffers.at[0].blocks.at[slot]));
  uint word = 0, own = 0;
  for (uint k = 0; k < kMeshCellsPerWord; ++k) {
    const uvec3 cell = localOf(lane * kMeshCellsPerWord + k);
    const uint inside = caseOf(cell);
    word |= inside << (8 * k);
    own += args.buffers.at[0].cellCases.at[inside].y >> 28;
    if (inside != 0 && inside != 255) noteVertices(cell, inside);
  }
  args.buffers.at[0].cases.at[slot * kMeshCaseWords + lane] = word;
  if (own > 0) atomicAdd(triangles, own);
  barrier();
  if (lane < kMeshMaskWords && ownMasks[lane] != 0)
    atomicOr(args.buffers.at[0].masks.at[slot * kMeshMaskWords + lane], ownMasks[lane]);
  if (lane == 0) args.buffers.at[0].triangleStarts.at[slot] = triangles;
}
