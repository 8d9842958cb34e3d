#version 460
#extension GL_GOOGLE_include_directive : require
// An invocation that lives for as long as `count` atomic additions take: unlike arithmetic alone, a compiler does not
// move them past the clock.
#include "shaders/lib/index.glsl"
#include "tests/gpu/add_one.h"

layout(push_constant, scalar) uniform Push { AddOneArgs args; };

void main() {
  if (threadIndex() != 0) return;
  for (uint i = 0; i < args.count; ++i) atomicAdd(args.to.at[0], 1);
}
