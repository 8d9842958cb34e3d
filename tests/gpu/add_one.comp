#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/index.glsl"
#include "tests/gpu/add_one.h"

layout(push_constant, scalar) uniform Push { AddOneArgs args; };

void main() {
  const uint i = threadIndex();
  if (i < args.count) args.to.at[i] = args.from.at[i] + 1;
}
