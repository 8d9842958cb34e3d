#version 460
#extension GL_GOOGLE_include_directive : require
// Catching up with the edit log, the last pass: writes each point's last entry, and clears its mark for the next range.
// An earlier entry of the same point may read the mark before or after that; in neither case does it find its own
// number.
#include "shaders/lib/index.glsl"
#include "shaders/shared/brush.h"
#include "shaders/shared/drawn_cloud.h"

layout(push_constant, scalar) uniform Push { CatchUpArgs args; };
#include "shaders/render/changed_buckets.glsl"
#include "shaders/render/changed_point.glsl"

void main() {
  const uint i = threadIndex();
  if (i >= args.entryCount) return;
  // Field by field: the validation layer of Debian 12 overestimates the size of the load of a whole entry.
  const uint slot = (args.firstSlot + i) & args.slotMask;
  const uint state = args.entries.at[slot].id;
  const uint id = state & ~kPointGone;
  if (id >= args.pointCount || args.latest.at[id] != i + 1) return;
  // A point with a NaN as position is not drawn.
  const bool gone = (state & kPointGone) != 0;
  const vec3 place = gone ? vec3(uintBitsToFloat(0x7fc00000u)) : args.entries.at[slot].position;
  const vec4 point = vec4(place, uintBitsToFloat(gone ? kEmptySlot : id));
  const vec3 normal = args.entries.at[slot].normal;
  const vec4 before = args.positions.at[id];
  if (changesDiscs(before, args.normals.at[id].xyz, !gone, place, normal)) {
    markBucketOf(before);
    markBucketOf(point);
  }
  args.positions.at[id] = point;
  args.normals.at[id].xyz = normal;
  const uint color = args.entries.at[slot].color;
  if (args.colored != 0) args.colors.at[id] = color == 0 ? kUnpainted : color;  // 0: it has no colour (yet, or again)
  args.latest.at[id] = 0;
  if (!gone && id >= args.end.at[0]) atomicMax(args.end.at[0], id + 1);  // a stale read is smaller
}
