#version 460
#extension GL_GOOGLE_include_directive : require
// Spacing of the points around each point of a cloud as loaded, and the rest position of each. Run twice: first to find
// the points that count, one at each position. If there are too many neighbours to visit, half of the support radius is
// used, and so on. In double precision: engine/edit/cpu_sculpture.cpp. One subgroup for each slot.
#include "shaders/lib/index.glsl"
#include "shaders/lib/edit_buffers.glsl"
#include "shaders/shared/frame.h"
#include "shaders/shared/weight.h"

layout(push_constant, scalar) uniform Push { SpacingArgs args; };
#include "shaders/lib/neighbours.glsl"

const float kFar = 3.0e38;

uint selfId;
vec3 selfNormal, axisU, axisV;
float radius;
// Of this invocation's neighbours.
bool firstOfPlace;
float weights;
float nearest[kGapSectors];

void visitNeighbour(uint id, vec3 normal, vec3 d) {
  if (args.counts != 0) {
    if (id < selfId) firstOfPlace = false;
    return;
  }
  if (args.tables.at[0].examined.at[id] == 0 || dot(selfNormal, normal) <= kSameSheet) return;
  const float size = length(d);
  weights += wendland(size / radius);
  if (size == 0.0) return;
  const uint sector = sectorOf(dot(d, axisU), dot(d, axisV));
  [[unroll]] for (uint s = 0; s < kGapSectors; ++s)
    if (s == sector) nearest[s] = min(nearest[s], size);
}

// Upper median of the sectors that are not empty; 0 if all are.
float sectorSpacing() {
  float all[kGapSectors];
  uint filled = 0;
  [[unroll]] for (uint s = 0; s < kGapSectors; ++s) {
    all[s] = reduceMin(nearest[s]);
    filled += all[s] < kFar ? 1 : 0;
  }
  float median = 0.0;
  [[unroll]] for (uint s = 0; s < kGapSectors; ++s) {
    uint before = 0;
    [[unroll]] for (uint t = 0; t < kGapSectors; ++t) before += all[t] < all[s] || (all[t] == all[s] && t < s) ? 1 : 0;
    if (before == filled / 2 && filled > 0) median = all[s];
  }
  return median / kSectorSpacings;
}

// Whether all neighbours within `radius` were seen.
bool visitAll(vec3 center) {
  firstOfPlace = true;
  weights = 0.0;
  [[unroll]] for (uint s = 0; s < kGapSectors; ++s) nearest[s] = kFar;
  visitNeighbours(center, radius, walkBudget(kMaxExamined));
  return walkedAll();
}

void main() {
  const uint slot = workgroupIndex() * gl_NumSubgroups + gl_SubgroupID;
  if (slot >= args.cloud.slots) return;
  const vec4 position = args.cloud.positions.at[slot];
  selfId = floatBitsToUint(position.w);
  if (selfId == kEmptySlot) return;
  selfNormal = args.cloud.normals.at[slot].xyz;
  const float least = kMinSpacing * args.radius;
  if (args.counts != 0) {
    radius = least;
    visitAll(position.xyz);
    const bool alone = subgroupAll(firstOfPlace);
    if (!subgroupElect()) return;
    args.tables.at[0].examined.at[selfId] = alone ? 1 : 0;
    args.tables.at[0].rests.at[selfId] = position.xyz;
    return;
  }
  frameAround(selfNormal, axisU, axisV);
  radius = args.radius;
  while (!visitAll(position.xyz) && radius > 2.0 * least) radius *= 0.5;
  const float spacing = max(spacingFrom(radius, max(reduceAdd(weights), kMinWeights)), sectorSpacing());
  if (subgroupElect())
    args.tables.at[0].spacings.at[selfId] = clamp(spacing, least, kMaxSpacing * args.radius);
}
