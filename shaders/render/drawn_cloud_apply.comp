#version 460
#extension GL_GOOGLE_include_directive : require
// Catching up with the edit log, pass 2 of 2: each point's last entry is written, and its mark is taken away for the next
// range. An earlier entry of the same point may read the mark before or after that; it finds its own number neither way.
#include "shaders/lib/index.glsl"
#include "shaders/shared/drawn_cloud.h"

layout(push_constant, scalar) uniform Push { CatchUpArgs args; };

void main() {
  const uint i = threadIndex();
  if (i >= args.entryCount) return;
  const EditEntry entry = args.entries.at[(args.firstSlot + i) & args.slotMask];
  if (entry.id >= args.pointCount || args.latest.at[entry.id] != i + 1) return;
  args.positions.at[entry.id] = vec4(entry.position, 0);
  args.normals.at[entry.id] = vec4(entry.normal, 0);
  args.latest.at[entry.id] = 0;
}
