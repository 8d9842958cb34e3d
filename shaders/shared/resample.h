// How a surface that is stretched or crowded by an edit keeps its points: small functions and constants that C++ and
// GLSL share. The decisions themselves: engine/edit/resampling.hpp.
#ifndef PALPATE_SHARED_RESAMPLE_H
#define PALPATE_SHARED_RESAMPLE_H
#include "shaders/shared/hash_grid.h"

PALPATE_SHARED_BEGIN

// In target spacings, which are those of the cloud as it was loaded. Where the ends of a pair have two, the coarser one
// counts, so that dense ground never grows into sparse ground.
// A direction in which the nearest neighbour is further than this may have a gap. Less fills places that are only
// uneven, more leaves holes.
const float kWidestGap = 1.5f;
// It has one where its ends stand at least so far from how they stood to one another in the cloud as it was loaded: how
// uneven that was is no edit's business.
const float kTorn = 0.25f;
// A new point stands at least so far from every other one: less than half a gap, or no gap could be filled, and enough
// that no lattice of the target density has room for one (the middle of a rhombus with this clearance has its corners
// nearer than a gap).
const float kMinClearance = 0.7f;
// Of two points nearer to one another than this, one goes. Well below the clearance, or points would come and go.
const float kCrowded = 0.4f;
// Two points of the file are crowded only where they have come nearer to one another than this share of their distance
// as loaded, or stood in the same place, which is less than this many spacings wide.
const float kComeNearer = 0.75f, kSamePlace = 1e-3f;

// Of the support radius. The neighbourhood of a point is no wider than this, or kNeighbourhoodSpacings of its own
// target where that is more: far enough for what one tick may tear open, and on ground much denser than the radius is
// made for not so far that its neighbours are too many to visit.
const float kMinNeighbourhood = 0.5f;
const float kNeighbourhoodSpacings = 8.0f;
// Of the support radius: how far from a point that the brush has moved others may come because of it, from one to the
// next. With the longest move it makes one support radius beyond the brush.
const float kReach = 0.75f;

// Of the support radius: no target is smaller, and points nearer to one another than this count as one when the targets
// are measured, so that a heap of points in one place does not ask for more of them all around.
const float kMinSpacing = 0.03125f;
// Of the support radius: no target is larger, or a gap could be wider than what a point sees.
const float kMaxSpacing = 0.5f;

// Of the weights that a place sums up: fewer are no surface to measure a target by.
const float kMinWeights = 0.1f;

// Directions in the tangent plane that are examined by themselves: each neighbour of an even lattice has its own.
const uint kGapSectors = 6u;
// The least cosine between the normals of two points of one sheet; others are not neighbours here.
const float kSameSheet = 0.0f;
// At most so much are two points of the two sheets of a plate for one another.
const float kFarSheet = -0.5f;

// How much a neighbour counts when the normal of a point is fitted, 0 to 1, from the cosine between the two as they
// were: wholly along a bent sheet, a little across a right angle, by which a normal may turn at a fresh edge, and not
// at all from the far sheet of a plate.
PALPATE_FUNCTION float fitShare(float cosine) { return max(0.0f, min(1.0f, 0.25f + cosine)); }

// While a ball carves, nothing may stand outside the solid that it cuts, in target spacings. A place is through where
// a point that faces the other way, no further aside than kBeside, has less than kSkin before it. It has risen where
// nearly all that stand as they were loaded, the nearest of them most (weights fall with the fourth power), say that it
// is more than kSkin outside their tangent planes. At rest is what stands no further than kAtRest from where it stood.
const float kSkin = 0.1f, kBeside = 2.0f, kAtRest = 0.02f, kNearlyAll = 0.8f;
// No new point comes so near to where one would have to go, and not where half of them say so: else points would come
// and go for ever.
const float kBirthMargin = 0.1f, kHalfOfThem = 0.5f;

// A point that a tool pushes stops so many of its spacings before a sheet that is turned away from the tool.
const float kStopMargin = 0.4f;

// Whether a place is through, `offset` from a point that faces the other way, whose unit normal is `normal`.
PALPATE_FUNCTION bool isThrough(vec3 offset, vec3 normal, float spacing, float margin) {
  const float before = dot(offset, normal);  // negative inside
  const vec3 aside = offset - before * normal;
  return before > -(kSkin + margin) * spacing && dot(aside, aside) < kBeside * kBeside * spacing * spacing;
}

// Whether a point at rest with this unit normal says that a place so far from it has risen.
PALPATE_FUNCTION bool isAbove(vec3 offset, vec3 normal, float spacing, float margin) {
  return dot(offset, normal) > (kSkin - margin) * spacing;
}

// How thick the solid is under a new point, between two that know it or do not (kUnseen).
const float kUnseen = 3.0e38f;
PALPATE_FUNCTION float middleThickness(float a, float b) {
  return a < kUnseen && b < kUnseen ? 0.5f * (a + b) : min(a, b);
}

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

// How much of a bulge over the chord to a neighbour `offset` away stays below the tangent plane of the point, which is
// convex there, or adds nothing to what the chord itself is above it: 0 to 1.
PALPATE_FORMULA Real bulgeBelow(PALPATE_VEC3 offset, PALPATE_VEC3 normal, PALPATE_VEC3 bulge) {
  const Real rises = dot(bulge, normal), falls = max(Real(0.0), Real(-0.5) * dot(offset, normal));
  return rises > falls ? falls / rises : Real(1.0);
}

// Half way on the curved surface from a point to a neighbour `offset` away: the middle of a cubic that is tangent to
// the surface at both ends (Vlachos et al. 2001, section 3.1), right to the second order in curvature. At an edge,
// where the normals of the ends disagree, such a cubic leaves the solid: no more of it than stays within both tangent
// planes. Relative to the point.
PALPATE_FORMULA PALPATE_VEC3 halfWay(PALPATE_VEC3 offset, PALPATE_VEC3 normal, PALPATE_VEC3 otherNormal) {
  const PALPATE_VEC3 bulge = Real(0.125) * (dot(offset, otherNormal) * otherNormal - dot(offset, normal) * normal);
  return Real(0.5) * offset + min(bulgeBelow(offset, normal, bulge), bulgeBelow(-offset, otherNormal, bulge)) * bulge;
}

// Radius of the neighbourhood that a point with this target examines, `radius` the support radius, model units.
PALPATE_FUNCTION float neighbourhoodRadius(float target, float radius) {
  return min(radius, max(kNeighbourhoodSpacings * target, kMinNeighbourhood * radius));
}

// In target spacings: the upper median of the distances to the nearest neighbours in those sectors that have one, on
// even ground without order. No target is smaller than the one that this gives: beside a dense patch the sparse side
// counts.
const float kSectorSpacings = 1.15f;

// Insertions claim their places on a grid whose cells are as wide as the clearance, with one slot for a cell: the point
// with the smallest number has it; its insertion stands unless a point with a smaller number has one of the 26 cells
// about it and wants a place nearer than the clearance. `spacing`: the widest target, model units.
PALPATE_FUNCTION HashGrid claimGrid(float spacing) {
  HashGrid grid;
  grid.origin = vec3(0.0f);
  grid.inverseCell = 1.0f / (kMinClearance * spacing);
  grid.bucketMask = kClaimSlots - 1u;
  grid.blockBits = 0u;
  return grid;
}

PALPATE_SHARED_END
#endif
