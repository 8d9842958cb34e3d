#version 460
#extension GL_GOOGLE_include_directive : require
// The lattice: the value of every node of every block that is there. A workgroup treats a block.
#include "shaders/mesh/block_surface.glsl"

// The nodes of this invocation, in the block. Neighbouring invocations have neighbouring nodes (Morton 1966), so that
// they see the same points and pass over the same ones.
uvec3 localNode(uint k) {
  const uint code = k * kMeshWorkgroup + scanIndex();
  return uvec3(code & 1 | code >> 2 & 2 | code >> 4 & 4, code >> 1 & 1 | code >> 3 & 2 | code >> 5 & 4,
               code >> 2 & 1 | code >> 4 & 2 | code >> 6 & 4);
}

void main() {
  const uint slot = workgroupIndex();
  if (slot >= args.slots) return;
  const uvec3 block = blockOfNumber(args.lattice, args.buffers.at[0].blocks.at[slot]);
  MeshFloats values = args.buffers.at[0].now.values;
  if (args.update != 0 && args.buffers.at[0].touched.at[slot] == 0) {
    const uint before = slotOf(args.buffers.at[0].old.table, block);
    for (uint place = scanIndex(); place < kMeshBlockNodes; place += kMeshWorkgroup)
      values.at[slot * kMeshBlockNodes + place] = args.buffers.at[0].old.values.at[before * kMeshBlockNodes + place];
    return;
  }
  for (uint k = 0; k < kPlaces; ++k) {
    places[k] = nodePlace(args.lattice, block * kMeshBlockSide + localNode(k));
    wanted[k] = true;
  }
  findSurfaces(nodePlace(args.lattice, block * kMeshBlockSide),
               nodePlace(args.lattice, block * kMeshBlockSide + kMeshBlockSide - 1));
  for (uint k = 0; k < kPlaces; ++k)
    values.at[slot * kMeshBlockNodes + inBlock(localNode(k))] =
        surfaces[k].defined ? surfaces[k].distance : kMeshUndefined;
}
