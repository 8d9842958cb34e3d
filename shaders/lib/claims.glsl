// The table in which requests for new points claim their positions (shaders/shared/resample.h).
#ifndef PALPATE_LIB_CLAIMS_GLSL
#define PALPATE_LIB_CLAIMS_GLSL

#include "shaders/lib/edit_buffers.glsl"

// `support`: support radius, model units.
HashGrid claimsFor(float support) { return claimGrid(support / kSupportSpacings); }
uint claimAt(HashGrid grid, vec3 place) { return bucketOf(grid, cellOf(grid, place)); }

// Once the granted requests are known: clears the table. From request `first` on every `stride`-th.
void dropClaims(ResampleLists lists, uint most, float support, uint first, uint stride) {
  const uint requests = min(lists.now.requests, most);
  const HashGrid grid = claimsFor(support);
  for (uint i = first; i < requests; i += stride)
    if (lists.requests[i].inserts != 0) lists.claims[claimAt(grid, lists.requests[i].place)] = 0xffffffffu;
}

// After all requests of a tick: the request with the smallest id that claims a slot of the table writes the position of
// its point there.
void confirmClaims(ResampleLists lists, uint most, float support, uint first, uint stride) {
  const uint requests = min(lists.now.requests, most);
  const HashGrid grid = claimsFor(support);
  for (uint i = first; i < requests; i += stride) {
    if (lists.requests[i].inserts == 0) continue;
    const vec3 place = lists.requests[i].place;
    const uint claim = claimAt(grid, place);
    if (lists.claims[claim] == lists.requests[i].id) lists.claimed[claim] = place;
  }
}

// Whether a request owns its cell of the claims, and no request of a smaller id in the cells around it is too near. The
// whole subgroup calls it together.
bool claimStands(ResampleLists lists, HashGrid grid, vec3 place, uint id, float support) {
  const uint kCellsAbout = 27;
  const float clearance = kMinClearance * support / kSupportSpacings;
  const ivec3 cell = cellOf(grid, place);
  bool stands = lists.claims[bucketOf(grid, cell)] == id;
  for (uint c = gl_SubgroupInvocationID; c < kCellsAbout; c += gl_SubgroupSize) {
    const ivec3 about = cell + ivec3(c % 3, c / 3 % 3, c / 9) - 1;
    const uint claim = bucketOf(grid, about);
    if (lists.claims[claim] < id && distance(lists.claimed[claim], place) < clearance) stands = false;
  }
  return subgroupAll(stands);
}

#endif
