#version 460
#extension GL_GOOGLE_include_directive : require
// After points have moved and the index is updated: the normal of every moved point becomes the direction of least
// spread of its neighbours (Hoppe et al. 1992, section 3.2), on the side of their normals, and the point's present
// state is logged. One subgroup for each point.
#include "shaders/lib/index.glsl"
#include "shaders/lib/edit_buffers.glsl"
#include "shaders/lib/subgroup_sum.glsl"
#include "shaders/shared/carried_normal.h"
#include "shaders/shared/plane_fit.h"

layout(push_constant, scalar) uniform Push { RefitNormalsArgs args; };
#include "shaders/lib/log_points.glsl"
#include "shaders/lib/neighbours.glsl"

vec3 facing;   // the normal before
float radius;  // of the neighbourhood
// Of this invocation's neighbours.
Moments moments;
vec3 sides;  // sum of w n, with the normals before

void visitNeighbour(uint id, vec3 normal, vec3 d) {
  const float share = fitShare(dot(normal, facing));
  if (share <= 0.0) return;
  const float w = share * wendland(length(d) / radius);
  addNeighbour(moments, d, w);
  sides += w * normal;
}

Moments momentsAbout(vec3 center, out vec3 side) {
  moments = Moments(0.0, 0, vec3(0.0), vec3(0.0), vec3(0.0));
  sides = vec3(0.0);
  visitNeighbours(center, radius, kNeighbourWorkBudget);
  const vec4 mean = subgroupSum(vec4(moments.mean, moments.weight));
  side = subgroupSum(vec4(sides, 0.0)).xyz;
  const vec4 diagonal = subgroupSum(vec4(moments.diagonal, float(moments.neighbours)));
  const vec4 mixed = subgroupSum(vec4(moments.mixed, 0.0));
  return Moments(mean.w, uint(diagonal.w), mean.xyz, diagonal.xyz, mixed.xyz);
}

// Its sign follows most of the normals around it: at a fresh edge a normal may rotate by a right angle in one tick, so
// that its own old side means nothing. The far sheet of a plate does not count. Where a stroke has bent the surface by
// more, the pass that requests new points has found its side in the edit before.
vec3 fittedNormal(vec3 center, vec3 old, uint carried) {
  facing = old;
  vec3 side;
  const vec3 fitted = planeNormal(momentsAbout(center, side));
  vec3 normal = old;
  if (dot(fitted, fitted) > 0.5) normal = dot(fitted, old) < 0.0 ? -fitted : fitted;
  if (dot(normal, side) < 0.0) normal = -normal;
  return carried != 0 && isAgainst(unpackedCarried(carried), normal) ? -normal : normal;
}

void main() {
  if (args.update.at[0].failed != 0) return;
  const uint changed = args.update.at[0].changed, head = args.head.at[0];
  const uint tick = examines(args.lists) ? args.lists.now.tick + 1 & kTickBits : 0;
  const uint stride = gl_NumWorkGroups.x * gl_NumSubgroups;
  for (uint which = workgroupIndex() * gl_NumSubgroups + gl_SubgroupID; which < changed; which += stride) {
    const uint i = args.changed.at[which];
    const vec4 position = args.cloud.positions.at[i];
    const vec4 before = args.cloud.normals.at[i];
    const uint id = floatBitsToUint(position.w);
    const bool refits = before.w == kMarkRefit;
    const bool isExamined = refits && examines(args.lists);
    // Loaded before the neighbours are visited, to hide the latency.
    const uint color = colorOf(args.tables, id);
    const uint parent = parentOf(args.tables, id);
    float spacing = kNotExamined;
    if (isExamined) spacing = args.tables.at[0].spacings.at[parent];
    radius = isExamined ? neighbourhoodRadius(spacing, args.radius) : args.radius;
    uint noted = 0, carried = 0;
    if (isExamined) {
      noted = args.tables.at[0].examined.at[id];
      if ((noted & (kIsExamined | kTickBits)) == (kIsExamined | tick - 1 & kTickBits))
        carried = args.tables.at[0].carried.at[id];
    }
    vec3 normal = before.xyz;
    if (refits) normal = fittedNormal(position.xyz, normal, carried);
    if (subgroupElect()) {
      args.fitted.at[which] = vec4(normal, spacing);
      if (isExamined) {
        const uint blocked = (noted & kTickBits) == tick ? noted & kIsBlocked : 0;
        args.tables.at[0].examined.at[id] = kIsExamined | blocked | tick;
      }
      logPoint(head + which, position.xyz, id, normal, color, parent);
    }
  }
  logGone(head + changed);
}
