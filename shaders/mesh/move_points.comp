#version 460
#extension GL_GOOGLE_include_directive : require
// Sets the points of an edit, and records their positions before. No point occurs twice.
#extension GL_EXT_buffer_reference : require
layout(buffer_reference) buffer MeshMoves;
layout(buffer_reference) buffer MeshBuffersOf;
#include "shaders/lib/contact_buffers.glsl"
#include "shaders/lib/index.glsl"
#include "shaders/shared/mesh.h"

layout(push_constant, scalar) uniform Push { MeshMoveArgs args; };

void main() {
  const uint k = threadIndex();
  if (k >= args.count) return;
  const uint id = args.moves.at[k].id;
  const vec4 before = args.positions.at[id];
  const float nowhere = uintBitsToFloat(0x7fc00000u);
  args.moves.at[k].from = floatBitsToUint(before.w) == kEmptySlot ? vec3(nowhere) : before.xyz;
  const vec3 to = args.moves.at[k].to;
  const bool gone = floatBitsToUint(to.x) == 0x7fc00000u;
  args.positions.at[id] = vec4(gone ? vec3(0.0) : to, uintBitsToFloat(gone ? kEmptySlot : id));
  args.normals.at[id] = vec4(args.moves.at[k].normal, 0.0);
  if (args.colored != 0) args.colors.at[id] = args.moves.at[k].color;
}
