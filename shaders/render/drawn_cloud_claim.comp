#version 460
#extension GL_GOOGLE_include_directive : require
// Catching up with the edit log, the first pass: finds each point's last entry, since a point may occur several times
// in a range and invocations run in no order.
#include "shaders/lib/index.glsl"
#include "shaders/shared/drawn_cloud.h"

layout(push_constant, scalar) uniform Push { CatchUpArgs args; };

void main() {
  const uint i = threadIndex();
  if (i >= args.entryCount) return;
  const uint id = args.entries.at[(args.firstSlot + i) & args.slotMask].id & ~kPointGone;
  if (id < args.pointCount) atomicMax(args.latest.at[id], i + 1);
}
