#version 460
#extension GL_GOOGLE_include_directive : require
// Grants requests for new points, which are then created by the next edit: those that no request of a smaller id
// blocks. One subgroup for each request; the last workgroup to finish sorts the granted ones by the ids of their
// points. The last pass of an edit.
#include "shaders/lib/index.glsl"
#include "shaders/lib/claims.glsl"
#include "shaders/lib/edit_end.glsl"

layout(push_constant, scalar) uniform Push { RequestArgs args; };

shared uint requesters[kMaxBirths];
shared uint granted[kMaxBirths];

// A different part of the points in each tick.
bool isHeard(uint id) {
  const uint scattered = (id ^ args.lists.now.tick * 19349663u) * 2654435761u;
  return scattered >> 16 << args.lists.now.thinning < 65536u;
}

void grantRequests() {
  const uint requests = min(args.lists.now.requests, args.most);
  const HashGrid grid = claimsFor(args.radius);
  const uint stride = gl_NumWorkGroups.x * gl_NumSubgroups;
  for (uint i = workgroupIndex() * gl_NumSubgroups + gl_SubgroupID; i < requests; i += stride) {
    const uint id = args.lists.requests[i].id;
    if (args.lists.requests[i].inserts == 0 || !isHeard(id)) continue;
    if (!claimStands(args.lists, grid, args.lists.requests[i].place, id, args.radius) || !subgroupElect()) continue;
    const uint birth = atomicAdd(args.lists.now.births, 1);
    if (birth < kMaxBirths) args.lists.births[birth] = i;
  }
}

// One workgroup.
void orderBirths() {
  const uint requested = args.lists.now.births;
  const uint births = requested > kMaxBirths ? 0 : requested;
  for (uint i = gl_LocalInvocationIndex; i < births; i += gl_WorkGroupSize.x) {
    granted[i] = args.lists.births[i];
    requesters[i] = args.lists.requests[granted[i]].id;
  }
  barrier();
  for (uint i = gl_LocalInvocationIndex; i < births; i += gl_WorkGroupSize.x) {
    uint before = 0;
    for (uint other = 0; other < births; ++other) before += requesters[other] < requesters[i] ? 1 : 0;
    args.lists.births[before] = granted[i];
    const vec3 place = args.lists.requests[granted[i]].place;
    const uint at = claimAt(claimsFor(args.radius), place);
    args.lists.grantedAt[at] = place;
    args.lists.grantedIn[at] = args.tables.at[0].tool.at[0].tool.stroke;
  }
  barrier();
  if (gl_LocalInvocationIndex != 0) return;
  args.lists.now.births = births;
  const uint thinning = args.lists.now.thinning;
  args.lists.now.thinning = requested > kMaxBirths ? min(thinning + 1, 15) : thinning - min(thinning, 1);
}

void main() {
  const bool failed = args.update.at[0].failed != 0;
  if (!failed) grantRequests();
  if (!finishesLast(args.update)) return;
  if (!failed) {
    orderBirths();
    dropClaims(args.lists, args.most, args.radius, gl_LocalInvocationIndex, gl_WorkGroupSize.x);
  }
  endEdit(args.end.report, args.end.resampling, args.end.empty, args.update, args.lists);
}
