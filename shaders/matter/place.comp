#version 460
#extension GL_GOOGLE_include_directive : require
// Sorts slots by cell, and within a cell by arrival.
#include "shaders/lib/index.glsl"
#include "shaders/shared/matter_passes.h"

layout(push_constant, scalar) uniform Push { MatterPlaceArgs args; };

#include "shaders/lib/matter_setting.glsl"

void main() {
  const uint i = threadIndex();
  if (i >= args.particles || !needsLists()) return;
  args.order.at[args.firsts.at[args.cells.at[i]] + args.arrivals.at[i]] = i;
}
