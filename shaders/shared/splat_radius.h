// How wide a point's disc must be to close the surface around it.
//
// Discs close a surface where each covers its own Voronoi cell. The cell's border lies in the direction u of the
// tangent plane at min |d|^2 / (2 d . u) over the offsets d to its neighbours; the farthest border in a few directions
// is the radius. Only neighbours within 63 degrees of a direction count there: beyond a border of the surface there are
// none. That direction is open, as is one whose border is much farther than the others, and the disc does not reach for
// it. Nothing beyond twice the answer can change it, so that a search may begin close by.
//
// At a sharp convex edge a disc would stand out over the other side. There it is clipped along the line in which the
// planes of the two sides meet (after Zwicker et al. 2004, "Perspective accurate splatting", section 5), but keeps its
// own Voronoi cell.
#ifndef PALPATE_SHARED_SPLAT_RADIUS_H
#define PALPATE_SHARED_SPLAT_RADIUS_H
#include "shaders/shared/spatial_hash.h"

PALPATE_SHARED_BEGIN

// Directions are taken in this many pairs, evenly turned.
const uint kSplatDirectionPairs = 6;
// The least cosine between a direction and a neighbour that counts in it.
const float kSplatAhead = 0.45f;
// Over the farthest border: a corner of a Voronoi cell lies up to a quarter farther than the border in the nearest
// direction (a square lattice, 15 degrees off); the rest blends normals and closes what noise opens. Less shows facets
// and cracks from close by, more lets corners stand out.
const float kSplatCover = 1.4f;
// The direction with this rank, nearest border first, says what is usual about a point; at a corner of a sheet hardly
// more are closed.
const uint kSplatUsualRank = 5;
// In usual borders: farther ones are open. Less leaves the gaps of random samplings open, more lets borders grow.
const float kSplatOpen = 4.5f;
// The same for a point that has an open direction: at corners of a sheet the others are no measure of its gaps.
const float kSplatOpenAtBorder = 3.0f;
// In mean spacings. The first search goes so far; where that is not enough the next goes twice as far.
const float kSplatFirstSearch = 3.2f;
// In mean spacings: no border farther than this is believed.
const float kSplatWidest = 4.0f;
// Points of one cell with an even surface in it; where there are more, the first search is shorter.
const uint kSplatUsualInCell = 12;
// In spacings, where a point has no normal and so no plane to look in: wide enough for most random samplings.
const float kSplatWithoutPlane = 1.3f;
// Points that such a point asks for.
const uint kSplatFewest = 6;
// The least cosine between the normals of two points of one sheet.
const float kSplatSameSheet = 0.0f;
// Cosines between normals of the two sides of a sharp edge: from 37 to 120 degrees.
const float kSplatSharp = 0.8f;
const float kSplatSharpest = -0.5f;
// In radii: the other side of an edge that a disc reaches has points so near.
const float kSplatEdgeReach = 2.0f;
// Work of all searches of a subgroup (shaders/lib/neighbour_walk.glsl), and of the one for the other side of an edge.
// Past it the answer comes from what was seen: only in a heap of points.
const uint kSplatWorkBudget = 1000;
const uint kSplatEdgeWorkBudget = 800;
// Points that either examines at least, whatever its subgroups.
const uint kSplatFewestExamined = 2000, kSplatEdgeFewestExamined = 1600;

struct SplatChangedArgs {
  CloudView cloud;                 // the points in hash order
  PALPATE_ADDRESS(Uints) reaches;  // as below
  PALPATE_ADDRESS(Uints) changed;  // a bit for each bucket: a point in it has come, gone or turned
  PALPATE_ADDRESS(Uints) list;     // gets the slots of the points, in any order
  PALPATE_ADDRESS(Uints) count;    // of them: one word
};
PALPATE_SIZE(SplatChangedArgs, 88);

struct SplatRadiusArgs {
  CloudView cloud;                 // the points in hash order
  PALPATE_ADDRESS(Vec4s) normals;  // by id; the radius goes into w
  PALPATE_ADDRESS(Uints) clips;    // by id: where a disc is cut off, packHalf2x16 (clipOf in shaders/render/splat.glsl)
  PALPATE_ADDRESS(Uints) reaches;  // by id: bits of how far the last search went, model units
  PALPATE_ADDRESS(Uints) list;     // slots of the points to measure, where `onlyListed` is set
  PALPATE_ADDRESS(Uints) largest;  // bits of the largest radius
  float spacing;                   // mean, model units
  float widest;                    // border that is believed, model units
  uint onlyListed;                 // 0: measures those of all slots
  uint count;                      // of slots, or of those that are listed
};
PALPATE_SIZE(SplatRadiusArgs, 112);

PALPATE_SHARED_END
#endif
