// How a surface that is stretched or crowded by an edit keeps its points: small functions and constants that C++ and
// GLSL share. The decisions themselves: engine/edit/resample_reference.hpp.
#ifndef PALPATE_SHARED_RESAMPLE_H
#define PALPATE_SHARED_RESAMPLE_H
#include "shaders/shared/hash_grid.h"

#ifdef __cplusplus
#include <glm/geometric.hpp>
#endif

PALPATE_SHARED_BEGIN

#ifdef __cplusplus
using glm::dot;
#endif

// In target spacings, which are those of the cloud as it was loaded.
// A direction in which the nearest neighbour is further than this has a gap. Less fills places that are only uneven,
// more leaves holes.
const float kWidestGap = 1.5f;
// A new point stands at least so far from every other one: less than half a gap, or no gap could be filled, and enough
// that no lattice of the target density has room for one (the middle of a rhombus with this clearance has its corners
// nearer than a gap).
const float kLeastClearance = 0.7f;
// Of two points nearer to one another than this, one goes. Well below the clearance, or points would come and go.
const float kCrowded = 0.4f;

// Of the support radius: no target is smaller, and points nearer to one another than this count as one when the targets
// are measured, so that a heap of points in one place does not ask for more of them all around.
const float kLeastSpacing = 0.03125f;

// Directions in the tangent plane that are looked at by themselves: each neighbour of an even lattice has its own.
const uint kSectors = 6u;
// The least cosine between the normals of two points of one sheet; others are not neighbours here.
const float kSameSheet = 0.0f;
// Slots of the table in which insertions claim their place: a power of two. A slot that two far places share makes one
// of them wait for the next tick.
const uint kClaimSlots = 65536u;

// The sector of a direction, `u` and `v` its coordinates in a tangent plane: counter-clockwise from the u axis.
PALPATE_FUNCTION uint sectorOf(float u, float v) {
  const float steep = 1.7320508f;
  const bool up = v > 0.0f || (v == 0.0f && u > 0.0f);
  const float forward = up ? u : -u;
  const float height = up ? v : -v;
  const uint third = height >= steep * (forward < 0.0f ? -forward : forward) ? 1u : forward > 0.0f ? 0u : 2u;
  return up ? third : third + 3u;
}

// Half way on the curved surface from a point to a neighbour `offset` away: the middle of a cubic that is tangent to
// the surface at both ends (Vlachos et al. 2001, section 3.1), right to the second order in curvature. Relative to the
// point.
PALPATE_FUNCTION vec3 halfWay(vec3 offset, vec3 normal, vec3 otherNormal) {
  return 0.5f * offset + 0.125f * (dot(offset, otherNormal) * otherNormal - dot(offset, normal) * normal);
}

// Insertions claim their places on a grid whose cells are as wide as the clearance, with one slot for a cell: the point
// with the smallest number has it; its insertion stands unless a point with a smaller number has one of the 26 cells
// about it and wants a place nearer than the clearance. `spacing`: the widest target, model units.
PALPATE_FUNCTION HashGrid claimGrid(float spacing) {
  HashGrid grid;
  grid.origin = vec3(0.0f);
  grid.inverseCell = 1.0f / (kLeastClearance * spacing);
  grid.bucketMask = kClaimSlots - 1u;
  grid.blockBits = 0u;
  return grid;
}

PALPATE_SHARED_END
#endif
