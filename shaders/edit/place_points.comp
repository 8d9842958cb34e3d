#version 460
#extension GL_GOOGLE_include_directive : require
// Brings points into the order of their ids: those of a half of the cloud that have not been changed, or given ones,
// with their other properties. One invocation for each.
#include "shaders/lib/index.glsl"
#include "shaders/lib/edit_buffers.glsl"

layout(push_constant, scalar) uniform Push { PlacePointsArgs args; };

void main() {
  const uint i = threadIndex();
  if (i >= args.count) return;
  const vec4 position = args.positionsIn.at[i];
  const uint id = floatBitsToUint(position.w);
  if (id == kEmptySlot) return;
  if (isNull(args.colorsIn)) {
    if ((args.changed.at[id / 32] >> id % 32 & 1) != 0) return;
  } else {
    if (!isNull(args.tables.at[0].colors)) args.tables.at[0].colors.at[id] = args.colorsIn.at[i];
    args.tables.at[0].founds.at[id].stroke = 0;
  }
  args.positionsOut.at[id] = position;
  args.normalsOut.at[id] = args.normalsIn.at[i];
}
