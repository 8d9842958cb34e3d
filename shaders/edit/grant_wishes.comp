#version 460
#extension GL_GOOGLE_include_directive : require
// Which wishes for new points come to pass with the next edit: those that no wish of a smaller id stands in the way of.
// One subgroup for each wish; the workgroup that is done last puts those that are granted into the order of the ids
// that wished. The last pass of an edit.
#include "shaders/lib/index.glsl"
#include "shaders/lib/claims.glsl"
#include "shaders/lib/edit_end.glsl"

layout(push_constant, scalar) uniform Push { WishArgs args; };

shared uint wishers[kMostBirths];
shared uint granted[kMostBirths];

// Another part of the points in each tick.
bool isHeard(uint id) {
  const uint scattered = (id ^ args.lists.now.tick * 19349663u) * 2654435761u;
  return scattered >> 16 << args.lists.now.thinning < 65536u;
}

void grantWishes() {
  const uint wishes = min(args.lists.now.wishes, args.most);
  const HashGrid grid = claimsFor(args.radius);
  const uint stride = gl_NumWorkGroups.x * gl_NumSubgroups;
  for (uint i = workgroupIndex() * gl_NumSubgroups + gl_SubgroupID; i < wishes; i += stride) {
    const uint id = args.lists.wishes[i].id;
    if (args.lists.wishes[i].inserts == 0 || !isHeard(id)) continue;
    if (!claimStands(args.lists, grid, args.lists.wishes[i].place, id, args.radius) || !subgroupElect()) continue;
    const uint birth = atomicAdd(args.lists.now.births, 1);
    if (birth < kMostBirths) args.lists.births[birth] = i;
  }
}

// One workgroup.
void orderBirths() {
  const uint wished = args.lists.now.births;
  const uint births = wished > kMostBirths ? 0 : wished;
  for (uint i = gl_LocalInvocationIndex; i < births; i += gl_WorkGroupSize.x) {
    granted[i] = args.lists.births[i];
    wishers[i] = args.lists.wishes[granted[i]].id;
  }
  barrier();
  for (uint i = gl_LocalInvocationIndex; i < births; i += gl_WorkGroupSize.x) {
    uint before = 0;
    for (uint other = 0; other < births; ++other) before += wishers[other] < wishers[i] ? 1 : 0;
    args.lists.births[before] = granted[i];
  }
  barrier();
  if (gl_LocalInvocationIndex != 0) return;
  args.lists.now.births = births;
  const uint thinning = args.lists.now.thinning;
  args.lists.now.thinning = wished > kMostBirths ? min(thinning + 1, 15) : thinning - min(thinning, 1);
}

void main() {
  const bool failed = args.update.at[0].failed != 0;
  if (!failed) grantWishes();
  if (!finishesLast(args.update)) return;
  if (!failed) {
    orderBirths();
    dropClaims(args.lists, args.most, args.radius, gl_LocalInvocationIndex, gl_WorkGroupSize.x);
  }
  endEdit(args.end, args.update, args.lists);
}
