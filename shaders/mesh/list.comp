#version 460
#extension GL_GOOGLE_include_directive : require
// The number of the block in every slot, from the table after its scan.
#include "shaders/mesh/lattice.glsl"

void main() {
  const uint number = threadIndex();
  if (number >= args.count) return;
  Uints table = args.buffers.at[0].now.table;
  const uint slot = table.at[number];
  if (table.at[number + 1] > slot) args.buffers.at[0].blocks.at[slot] = number;
}
