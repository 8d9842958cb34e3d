#version 460
#extension GL_GOOGLE_include_directive : require
// How far apart the points are about each point of a cloud as it was loaded. Run twice: first to find the points that
// count, one in each place. The weights of the neighbours within R on an even plane sum up to pi / 7 (R / spacing)^2.
// One subgroup for each slot.
#include "shaders/lib/index.glsl"
#include "shaders/lib/edit_buffers.glsl"
#include "shaders/lib/neighbours.glsl"
#include "shaders/lib/weight.glsl"

layout(push_constant, scalar) uniform Push { SpacingArgs args; };

uint selfId;
vec3 selfNormal;
bool firstOfPlace;
float weights;

void visitNeighbour(uint id, vec3 normal, vec3 d) {
  if (args.counts != 0) {
    if (id < selfId) firstOfPlace = false;
  } else if (args.tables.at[0].looks.at[id] != 0 && dot(selfNormal, normal) > kSameSheet) {
    weights += wendland(length(d) / args.radius);
  }
}

void main() {
  const uint slot = workgroupIndex() * gl_NumSubgroups + gl_SubgroupID;
  if (slot >= args.cloud.slots) return;
  const vec4 position = args.cloud.positions.at[slot];
  selfId = floatBitsToUint(position.w);
  if (selfId == kEmptySlot) return;
  selfNormal = args.cloud.normals.at[slot].xyz;
  const float least = kLeastSpacing * args.radius;
  firstOfPlace = true;
  weights = 0.0;
  visitNeighbours(args.cloud, position.xyz, args.counts != 0 ? least : args.radius, kWishWorkBudget);
  const bool alone = subgroupAll(firstOfPlace);
  const float sum = subgroupAdd(weights);
  if (!subgroupElect()) return;
  if (args.counts != 0) {
    args.tables.at[0].looks.at[selfId] = alone ? 1 : 0;
    return;
  }
  const float spacing = args.radius * sqrt(0.448798951 / max(sum, 0.1));
  args.tables.at[0].spacings.at[selfId] = clamp(spacing, least, args.radius / kSupportSpacings);
}
