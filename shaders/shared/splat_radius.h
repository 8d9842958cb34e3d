// Radius that a point's disc needs to close the surface around it.
//
// Discs close a surface if each covers its own Voronoi cell. The cell's border in the direction u of the tangent plane
// is at min |d|^2 / (2 d . u) over the offsets d to its neighbours; the farthest border in a few directions is the
// radius. Only neighbours within 63 degrees of a direction count in it: beyond a border of the surface there are none.
// Such a direction is open, as is one whose border is much farther than the others, and the disc does not extend to it.
// Points farther than twice the result cannot change it, so that a search may start with a small radius.
//
// A wide disc must be of a surface: if many of the points around are off its plane, or hardly any are there, as about
// points that float, it closes nothing, and has the radius of a usual one.
//
// At a sharp convex edge a disc would stand out over the other side. There it is clipped along the line where the
// planes of the two sides meet (after Zwicker et al. 2004, "Perspective accurate splatting", section 5), but keeps its
// own Voronoi cell. Where the other side is undercut, as under the rim of a dent, its plane passes behind the point:
// there the disc ends half way to the nearest point of that side, measured around the edge.
#ifndef PALPATE_SHARED_SPLAT_RADIUS_H
#define PALPATE_SHARED_SPLAT_RADIUS_H
#include "shaders/shared/spatial_hash.h"

PALPATE_SHARED_BEGIN

// Directions are taken in this many pairs, at equal angles.
const uint kSplatDirectionPairs = 6;
// Minimum cosine between a direction and a neighbour that counts in it.
const float kSplatAhead = 0.45f;
// Factor on the farthest border: a corner of a Voronoi cell is up to a quarter farther than the border in the nearest
// direction (a square lattice, 15 degrees off); the rest blends normals and closes gaps from noise. Less shows facets
// and cracks at close range, more lets corners stand out.
const float kSplatCover = 1.4f;
// The direction with this rank, nearest border first, gives the usual border of a point; at a corner of a sheet hardly
// more directions are closed.
const uint kSplatUsualRank = 5;
// In usual borders: a direction with a farther border is open. Less leaves gaps in random samplings, more lets borders
// grow.
const float kSplatOpen = 4.5f;
// The same for a point with an open direction: at corners of a sheet the other directions are not a measure of its
// gaps.
const float kSplatOpenAtBorder = 3.0f;
// In mean spacings. Radius of the first search; if it is not enough the next one is twice as wide.
const float kSplatFirstSearch = 3.2f;
// In mean spacings: a border farther than this is ignored.
const float kSplatWidest = 4.0f;
// Points of one cell with an even surface in it; if there are more, the first search is narrower.
const uint kSplatUsualInCell = 12;
// In mean spacings: wider discs must be of a surface. Less leaves gaps in uneven scans, more lets floating points stand
// out.
const float kSplatLone = 1.5f;
// Sine: a neighbour this far from the plane is off it. Of a surface at most the share kSplatOff is, and it has
// kSplatFewestAround neighbours.
const float kSplatOffPlane = 0.5f;
const float kSplatOff = 0.3f;
const uint kSplatFewestAround = 4;
// In spacings, for a point without a normal, and so without a plane to search in: wide enough for most random
// samplings.
const float kSplatWithoutPlane = 1.3f;
// Neighbours that such a point needs.
const uint kSplatFewest = 6;
// Minimum cosine between the normals of two points of one sheet.
const float kSplatSameSheet = 0.0f;
// Cosines between normals of the two sides of a sharp edge: from 37 to 120 degrees.
const float kSplatSharp = 0.8f;
const float kSplatSharpest = -0.5f;
// In radii: the other side of an edge counts if it has points this near.
const float kSplatEdgeReach = 2.0f;
// Points of the cells around a disc that all its searches visit together, and the search for the other side of an
// edge: so many for each invocation of a subgroup, of 16 at least. A cell counts as the points that share its bucket on
// average. Beyond it the result uses the points visited so far: only in dense clusters of points.
const uint kSplatVisitsOfCell = 4;
const uint kSplatVisitsEach = 124, kSplatEdgeVisitsEach = 100;
PALPATE_FUNCTION uint splatMostVisits(uint subgroup) { return kSplatVisitsEach * (subgroup < 16u ? 16u : subgroup); }
PALPATE_FUNCTION uint splatMostEdgeVisits(uint subgroup) {
  return kSplatEdgeVisitsEach * (subgroup < 16u ? 16u : subgroup);
}
// Of a bucket with more points than this only the first are visited.
const uint kSplatInBucketEach = 128;
PALPATE_FUNCTION uint splatMostInBucket(uint subgroup) {
  return kSplatInBucketEach * (subgroup < 16u ? 16u : subgroup);
}

// Points whose largest radius is kept, so that a picture need not read the discs of points that it leaves out.
const uint kDiscBlock = 32;

// In `reaches`: the disc is listed to be measured again.
const uint kSplatListed = 0x80000000u;

struct SplatChangedArgs {
  CloudView cloud;                 // the points in hash order
  PALPATE_ADDRESS(Uints) reaches;  // as below
  PALPATE_ADDRESS(Uints) changed;  // a bit for each bucket: a point in it was added, removed, moved or rotated
  PALPATE_ADDRESS(Uints) list;     // out: slots of the points, in any order
  PALPATE_ADDRESS(Uints) count;    // number of points in `list`: one word
};
PALPATE_SIZE(SplatChangedArgs, 88);

struct SplatRadiusArgs {
  CloudView cloud;                 // the points in hash order
  PALPATE_ADDRESS(Vec4s) normals;  // by id; the radius goes into w
  PALPATE_ADDRESS(Uints) clips;    // by id: where a disc is clipped, packHalf2x16 (clipOf in shaders/render/splat.glsl)
  PALPATE_ADDRESS(Uints) widths;   // of kDiscBlock ids each: bits of the largest radius ever measured, model units
  PALPATE_ADDRESS(Uints) reaches;  // by id: bits of the radius of the last search, model units; or kSplatListed
  PALPATE_ADDRESS(Uints) list;     // slots of the points to measure, if `onlyListed` is set
  PALPATE_ADDRESS(Uints) largest;  // bits of the largest radius, and of the largest reach
  float spacing;                   // mean, model units
  float widest;                    // maximum border that counts, model units
  uint onlyListed;                 // 0: measures the points of all slots
  uint count;                      // of slots, or of listed slots
};
PALPATE_SIZE(SplatRadiusArgs, 120);

PALPATE_SHARED_END
#endif
