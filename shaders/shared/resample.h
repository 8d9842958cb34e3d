// Keeps the density of points where an edit stretches or crowds a surface: small functions and constants that C++ and
// GLSL share. The decisions themselves are in engine/edit/resampling.hpp.
#ifndef PALPATE_SHARED_RESAMPLE_H
#define PALPATE_SHARED_RESAMPLE_H
#include "shaders/shared/hash_grid.h"

PALPATE_SHARED_BEGIN

// In target spacings, the local spacings of the cloud as loaded. If the ends of a pair have different ones, the coarser
// one counts, so that a dense region never grows into a sparse one.

// A direction whose nearest neighbour is further than this may have a gap. Less fills regions that are only uneven,
// more leaves holes.
const float kWidestGap = 1.5f;
// It has one if the offset between its ends has changed by at least this since the cloud was loaded: edits do not
// repair the unevenness of the cloud itself.
const float kTorn = 0.25f;
// Minimum distance of a new point from every other one: less than half a gap, or no gap could be filled, and large
// enough that no lattice of the target density has room for one (the middle of a rhombus with this clearance has its
// corners nearer than a gap).
const float kMinClearance = 0.7f;
// Of two points nearer to each other than this, one is removed. Well below the clearance, or points would be added and
// removed repeatedly.
const float kCrowded = 0.4f;
// Two points of the file are crowded only if they are nearer to each other than this share of their distance as loaded,
// or had the same position, which is less than kSamePlace spacings apart.
const float kComeNearer = 0.75f, kSamePlace = 1e-3f;

// Radius of the neighbourhood of a point: this many support radii, or kNeighbourhoodSpacings times the point's own
// target if that is more. The surface cannot open a wider gap in one tick, and where points are much denser than the
// support radius is chosen for, there are few enough neighbours to visit.
const float kMinNeighbourhood = 0.5f;
const float kNeighbourhoodSpacings = 8.0f;
// Maximum distance, in support radii, of a new point from the moved point that caused it, directly or through other
// new points. With the longest move that is one support radius beyond the brush.
const float kReach = 0.75f;

// Minimum target, in support radii. Points closer than this count as one when targets are measured, so that a
// cluster of points in one position does not request more of them all around.
const float kMinSpacing = 0.03125f;
// Maximum target, in support radii: with a larger one a gap could be wider than a point's neighbourhood.
const float kMaxSpacing = 0.5f;

// Minimum sum of weights at a position: with less there is no surface to measure a target by.
const float kMinWeights = 0.1f;

// Directions in the tangent plane that are examined separately: each neighbour of an even lattice has its own.
const uint kGapSectors = 6u;
// Minimum cosine between the normals of two points of one sheet; other points are not neighbours here.
const float kSameSheet = 0.0f;
// Maximum cosine between the normals of two points on the opposite sheets of a plate.
const float kFarSheet = -0.5f;

// Maximum cosine between the normals, as a stroke found them, of two points on different sides of a surface: of a rim,
// and of an inner corner, which a stroke may round.
const float kTwoSides = 0.3f, kTwoSidesInCorner = -0.3f;

// Maximum distance, in target spacings, of two neighbours as a stroke found them, or in the cloud as loaded: in a cloud
// of random points one in a hundred is further away.
const float kNeighboursApart = 3.0f;
// Factor on the width of a gap for rounding.
const float kAsWide = 1.001f;

// The ends of a gap as a stroke found them.
PALPATE_STRUCT(GapAsFound) {
  PALPATE_VEC3 rest;    // offset from the one to the other as loaded
  PALPATE_VEC3 offset;  // the same as found
  PALPATE_VEC3 normal;
  PALPATE_VEC3 otherNormal;
};
PALPATE_SINGLE(GapAsFound);

// Whether they were on one side of the surface. What a stroke stretches is one side: a new point between two has a
// normal of neither.
PALPATE_FORMULA bool areOneSide(PALPATE_OF(GapAsFound) found) {
  const bool isCorner = dot(found.offset, found.normal) > dot(found.offset, found.otherNormal);
  return dot(found.normal, found.otherNormal) >= Real(isCorner ? kTwoSidesInCorner : kTwoSides);
}

// Whether the gap has opened since, between neighbours. A brush that only moves points fills no other gap: between
// parts that it has brought nearer to each other, as in a fold, a new point would join what does not belong together. A
// ball that carves leaves nothing of what was between two points, and fills the gap whatever it was. `offset`: at
// present; `spacing`: the wider target, model units.
PALPATE_FORMULA bool hasOpened(PALPATE_OF(GapAsFound) found, PALPATE_VEC3 offset, Real spacing) {
  const Real apart = length(found.offset);
  return min(apart, length(found.rest)) <= Real(kNeighboursApart) * spacing && apart <= Real(kAsWide) * length(offset);
}

// Weight of a neighbour in the fit of a point's normal, 0 to 1, by the cosine between the two normals before: full
// along a bent sheet, small across a right angle, by which a normal may rotate at a fresh edge, and zero for the far
// sheet of a plate.
PALPATE_FUNCTION float fitShare(float cosine) { return max(0.0f, min(1.0f, 0.25f + cosine)); }

// While a ball carves, no point may be outside the solid that it cuts; in target spacings. A position is through if it
// is less than kSkin inside the surface at a point that faces the other way, at most kBeside aside. It has risen if
// nearly all neighbours at rest, weighted by the inverse fourth power of their distance, have it more than kSkin
// outside their tangent planes. A point is at rest if it is within kAtRest of its position as loaded.
const float kSkin = 0.1f, kBeside = 2.0f, kAtRest = 0.02f, kNearlyAll = 0.8f;
// No new point is created this near to where a point would be removed, nor where half of the neighbours at rest say so:
// otherwise points would be added and removed for ever.
const float kBirthMargin = 0.1f, kHalfOfThem = 0.5f;

// Whether a position is through, `offset` from a point that faces the other way, whose unit normal is `normal`.
PALPATE_FUNCTION bool isThrough(vec3 offset, vec3 normal, float spacing, float margin) {
  const float before = dot(offset, normal);  // negative inside
  const vec3 aside = offset - before * normal;
  return before > -(kSkin + margin) * spacing && dot(aside, aside) < kBeside * kBeside * spacing * spacing;
}

// Whether a position at this offset from a point at rest, with this unit normal, has risen over it.
PALPATE_FUNCTION bool isAbove(vec3 offset, vec3 normal, float spacing, float margin) {
  return dot(offset, normal) > (kSkin - margin) * spacing;
}

// Slots of the table in which requests for new points claim their positions: a power of two. If two distant positions
// share a slot, one of them waits for the next tick.
const uint kClaimSlots = 65536u;

// The sector of a direction, `u` and `v` its coordinates in a tangent plane: counter-clockwise from the u axis. Without
// branches, so that compilers vectorise it.
PALPATE_FUNCTION uint sectorOf(float u, float v) {
  const float steep = 1.7320508f;
  const float side = v != 0.0f ? v : u;
  const float forward = side > 0.0f ? u : -u;
  const float height = side > 0.0f ? v : -v;
  const uint third = height >= steep * (forward < 0.0f ? -forward : forward) ? 1u : forward > 0.0f ? 0u : 2u;
  return side > 0.0f ? third : third + 3u;
}

// Factor on a bulge over the chord to a neighbour `offset` away, with which the bulge stays below the tangent plane of
// the point, which is convex there, or adds nothing to the chord's own height above it: 0 to 1.
PALPATE_FORMULA Real bulgeBelow(PALPATE_VEC3 offset, PALPATE_VEC3 normal, PALPATE_VEC3 bulge) {
  const Real rises = dot(bulge, normal), falls = max(Real(0.0), Real(-0.5) * dot(offset, normal));
  return rises > falls ? falls / rises : Real(1.0);
}

// Relative to a point, the middle of the curved surface to a neighbour `offset` away: that of a cubic tangent to the
// surface at both ends (Vlachos et al. 2001, section 3.1), right to the second order in curvature. At an edge, where
// the normals disagree, such a cubic leaves the solid: only its part within both tangent planes is used.
PALPATE_FORMULA PALPATE_VEC3 halfWay(PALPATE_VEC3 offset, PALPATE_VEC3 normal, PALPATE_VEC3 otherNormal) {
  const PALPATE_VEC3 bulge = Real(0.125) * (dot(offset, otherNormal) * otherNormal - dot(offset, normal) * normal);
  return Real(0.5) * offset + min(bulgeBelow(offset, normal, bulge), bulgeBelow(-offset, otherNormal, bulge)) * bulge;
}

// Radius of the neighbourhood that a point with this target examines, `radius` the support radius, model units.
PALPATE_FUNCTION float neighbourhoodRadius(float target, float radius) {
  return min(radius, max(kNeighbourhoodSpacings * target, kMinNeighbourhood * radius));
}

// In target spacings: the upper median of the distances to the nearest neighbours in the sectors that have one, on even
// ground without order. The target that it gives is a lower bound: beside a dense patch the sparse side counts.
const float kSectorSpacings = 1.15f;

// Requests claim positions on a grid whose cells are as wide as the clearance, with one slot for a cell: the point with
// the smallest id owns it; its request stands unless a point with a smaller id owns one of the 26 cells around it and
// claims a position nearer than the clearance. `spacing`: the widest target, model units.
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
