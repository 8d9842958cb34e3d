#version 460
#extension GL_GOOGLE_include_directive : require
// The number of vertices of every block, and for every word of its masks those before it. One workgroup for each block,
// one invocation for each word.
#include "shaders/lib/workgroup_scan.glsl"
#include "shaders/mesh/lattice.glsl"

void main() {
  const uint slot = workgroupIndex();
  if (slot >= args.slots) return;
  const uint word = slot * kMeshMaskWords + scanIndex();
  uint count;
  args.buffers.at[0].ranks.at[word] = workgroupExclusiveScan(bitCount(args.buffers.at[0].masks.at[word]), count);
  if (scanIndex() == 0) args.buffers.at[0].now.vertexStarts.at[slot] = count;
}
