#version 460
#extension GL_GOOGLE_include_directive : require
// The lattice: the value of every node of every block that is there. One invocation for each node.
#include "shaders/mesh/field.glsl"

void main() {
  const uint thread = threadIndex();
  const uint slot = thread / kMeshBlockNodes, place = thread % kMeshBlockNodes;
  if (slot >= args.slots) return;
  const uvec3 block = blockOfNumber(args.lattice, args.buffers.at[0].blocks.at[slot]);
  MeshFloats values = args.buffers.at[0].now.values;
  if (args.update != 0 && args.buffers.at[0].touched.at[slot] == 0) {
    const uint before = slotOf(args.buffers.at[0].old.table, block);
    values.at[thread] = args.buffers.at[0].old.values.at[before * kMeshBlockNodes + place];
    return;
  }
  const FieldSample field = fieldAt(nodePlace(args.lattice, block * kMeshBlockSide + localOf(place)), false);
  values.at[thread] = field.defined ? field.value : kMeshUndefined;
}
