#version 460
#extension GL_GOOGLE_include_directive : require
// The lattice: the value of every node of every block that is there. A workgroup treats a block, a quarter of it at a
// time: a smaller box sees fewer points.
#include "shaders/mesh/block_surface.glsl"

const uint kQuarters = kMeshBlockNodes / kMeshWorkgroup;
const uvec3 kQuarterSides = uvec3(kMeshBlockSide, kMeshBlockSide / 2, kMeshBlockSide / 2);

// The node of this invocation in a quarter. Neighbouring invocations have neighbouring nodes (Morton 1966), so that
// they see the same points and pass over the same ones.
uvec3 nodeInQuarter() {
  const uint code = scanIndex();
  return uvec3(code & 1 | code >> 2 & 2 | code >> 4 & 4, code >> 1 & 1 | code >> 3 & 2, code >> 2 & 1 | code >> 4 & 2);
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
  for (uint quarter = 0; quarter < kQuarters; ++quarter) {
    const uvec3 first = kQuarterSides * uvec3(0, quarter & 1, quarter >> 1);
    const uvec3 local = first + nodeInQuarter(), base = block * kMeshBlockSide;
    const Surface surface =
        findSurface(nodePlace(args.lattice, base + first), nodePlace(args.lattice, base + first + kQuarterSides - 1),
                    nodePlace(args.lattice, base + local), true)
            .surface;
    values.at[slot * kMeshBlockNodes + inBlock(local)] = surface.defined ? surface.distance : kMeshUndefined;
  }
}
