#version 460
#extension GL_GOOGLE_include_directive : require
// The vertices of every block, and of every word of its masks those before it. One invocation for each block.
#include "shaders/mesh/lattice.glsl"

void main() {
  const uint slot = threadIndex();
  if (slot >= args.slots) return;
  uint count = 0;
  for (uint word = slot * kMeshMaskWords; word < (slot + 1) * kMeshMaskWords; ++word) {
    args.buffers.at[0].ranks.at[word] = count;
    count += bitCount(args.buffers.at[0].masks.at[word]);
  }
  args.buffers.at[0].now.vertexStarts.at[slot] = count;
}
