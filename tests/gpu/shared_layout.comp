#version 460
#extension GL_GOOGLE_include_directive : require
// Reads a struct written by C++ and writes its numbers to an array.
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference : require
layout(buffer_reference) buffer LayoutPatterns;
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Floats { float at[]; };
#include "tests/gpu/shared_layout.h"
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer LayoutPatterns { LayoutPattern at[]; };
#include "shaders/lib/index.glsl"

layout(push_constant, scalar) uniform Push { LayoutArgs args; };

void main() {
  if (threadIndex() != 0) return;
  const float scale = float(args.scale);
  args.numbers.at[0] = scale * float(args.pattern.at[1].a);
  for (uint k = 0; k < 3; ++k) args.numbers.at[1 + k] = scale * args.pattern.at[1].b[k];
  for (uint k = 0; k < 2; ++k) args.numbers.at[4 + k] = scale * args.pattern.at[1].c[k];
  args.numbers.at[6] = scale * float(args.pattern.at[1].d);
  for (uint k = 0; k < 3; ++k) args.numbers.at[7 + k] = scale * args.pattern.at[1].grid.origin[k];
  args.numbers.at[10] = scale * args.pattern.at[1].grid.inverseCell;
  args.numbers.at[11] = scale * float(args.pattern.at[1].grid.bucketMask);
  args.numbers.at[12] = scale * float(args.pattern.at[1].grid.blockBits);
  for (uint k = 0; k < 4; ++k) args.numbers.at[13 + k] = scale * args.pattern.at[1].e[k];
  for (uint column = 0; column < 4; ++column)
    for (uint row = 0; row < 4; ++row)
      args.numbers.at[17 + column * 4 + row] = scale * args.pattern.at[1].m[column][row];
}
