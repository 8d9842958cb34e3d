// Effect of a brush on one point in one tick. C++ and GLSL agree up to rounding: only sums, products, quotients and
// square roots are used.
#ifndef PALPATE_SHARED_BRUSH_H
#define PALPATE_SHARED_BRUSH_H
#include "shaders/shared/brush_traits.h"
#include "shaders/shared/sheet_grid.h"

PALPATE_SHARED_BEGIN

// In support radii: maximum displacement of a point in one edit, so that a resting proxy keeps its surface.
const float kLongestMove = 0.25f;
// In support radii: points deeper than this in a carving ball are removed at once. Less tears the surface when the
// hand is fast; more leaves remains of the model inside the ball.
const float kCarveDepth = 2.0f;
// In radii of the brush: displacement of a point in one tick by the full effect of inflate.
const float kInflateStep = 1e-3f;
// In radii of the brush: a point nearer to the tool's axis than this is displaced towards the tip.
const float kAtCenter = 1e-6f;
// Cosines between the normal that the stroke found at a point and the tool's axis: below the first the effect on the
// point decreases; below the second it is zero, since the point belongs to another side of the model, which the tool
// does not touch.
const float kTurnedAway = -0.3f, kOtherSide = -0.8f;
// The same cosines: below the first a face that the ball meets with its side begins to yield along its own normal, and
// below the second it does not yield along the axis at all.
const float kSlope = 0.5f, kWall = 0.17f;
// In radii of the brush: a face yields along its normal if the tool's axis is this far in front of it.
const float kInFront = 0.25f;
// The same cosines: a face begins to overhang below the first, and does below the second; it overhangs the hand if it
// was this many radii above the surface there.
const float kUpright = 0.0f, kOverhang = -0.25f, kAbove = 0.25f;
// Units of a measured weight, normal and height of 1: integers, so that sums do not depend on the order of addition.
const float kWeightSteps = 63.0f, kNormalSteps = 511.0f, kHeightSteps = 255.0f;
const float kMaxHeight = 4.0f;  // in radii of the brush
// Distance to a thing that nothing has seen, model units.
const float kUnseen = 3.0e38f;
// In support radii: how far a stroke moves a point before the point has looked at what lies ahead.
const float kFirstStep = 1.0f / 64.0f;
// Room below this share of a step blocks it; a point that has not looked yet has more. In support radii: shorter steps
// do not count.
const float kBlocks = 1.0f / 32.0f, kCountedStep = 1e-4f;
// RGBA8 that paint starts from for a point without a colour (0): kUnpainted of engine/core/point_state.hpp.
const uint kUnpainted = 0xff93aac8u;

PALPATE_STRUCT(Brush) {
  uint kind;         // kBrush...
  uint traits;       // of that kind: kBrushes
  uint falloff;      // exponent of the weight, 0 to kMaxFalloff
  Real radius;       // model units
  Real longestMove;  // of one point in one edit, model units (kLongestMove)
  Real support;      // support radius, model units
  uint color;        // RGBA8
};
PALPATE_SINGLE(Brush);
PALPATE_SIZE(Brush, 28);

PALPATE_FORMULA bool brushHas(PALPATE_OF(Brush) brush, uint trait) { return (brush.traits & trait) != 0u; }

// Pose of the tool in one edit, relative to the cloud's origin, model units. The tool is fixed to the hand, and its
// axis is the normal of the surface there as the stroke found it: engine/core/brush_stroke.hpp.
PALPATE_STRUCT(BrushTool) {
  PALPATE_VEC3 center;   // push and carve: of the ball; others: surface position under the hand as the stroke found it
  uint acts;             // 0: no effect
  PALPATE_VEC3 outward;  // unit, the axis
  Real shaft;            // push and carve: length of the tool outwards from the centre, as wide as the ball
  PALPATE_VEC3 motion;   // grab: displacement of the hand since the grab began
  Real share;            // of the full effect, in this edit; inflate: ticks times strength
  PALPATE_VEC3 middle;   // of the ball around the tool's reach
  Real reach;            // radius of that ball
  PALPATE_VEC3 hand;     // position of the tool on the path of the HIP
  Real hearing;          // points found within this distance of `hand` measure the surface
  Real height;           // push: depth, inflate: displacement, at the centre, model units
  uint stroke;           // number, from 1 on
  uint sampling;         // one of 2^sampling points is measured
  uint closes;           // not 0: the brush has not acted for long; no point is inserted any more
  // Grids of the surface around the hand: side of the cells, corner of the one that this edit fills, and corner
  // of the one whose connected cells are known.
  Real cell;
  PALPATE_VEC3 touched;  // the proxy; grab: the surface where it took hold
  PALPATE_VEC3 entersFrom;
  PALPATE_VEC3 connectedFrom;
  // With symmetry, the plane, with its unit normal to the side on which this tool acts; else zero. Positions with
  // dot(ownSide, position) = ownFrom are on it.
  PALPATE_VEC3 ownSide;
  Real ownFrom;
  uint isImage;  // not 0: the mirror image of the hand's tool
};
PALPATE_SINGLE(BrushTool);
PALPATE_SIZE(BrushTool, 156);

// A tool with the cells of the surface on which it acts.
struct PlacedTool {
  BrushTool tool;
  uint connected[kSheetWords];  // a bit for each cell
};
PALPATE_SIZE(PlacedTool, 668);

// A point as the stroke found it.
PALPATE_STRUCT(FoundPoint) {
  PALPATE_VEC3 position;
  PALPATE_VEC3 normal;
  Real room;  // how far the stroke may move it until it looks ahead again, model units; kUnseen: any distance
  Real lock;  // weight of its lock, 0 to 1: the share of the brush's effect that it does not get
};
PALPATE_SINGLE(FoundPoint);

// The share of a brush's effect that the lock of a point leaves. A cut has no part: carve acts wholly on points that
// are locked by half at most, and on no others.
PALPATE_FORMULA Real unlockedShare(PALPATE_OF(FoundPoint) found) { return Real(1.0) - found.lock; }
PALPATE_FORMULA bool mayBeCut(PALPATE_OF(FoundPoint) found) { return unlockedShare(found) >= Real(0.5); }

// Room of a new point, from those of its two ends.
PALPATE_FUNCTION float middleRoom(float a, float b) { return a < kUnseen && b < kUnseen ? 0.5f * (a + b) : min(a, b); }

// A point after the brush.
PALPATE_STRUCT(Brushed) {
  PALPATE_VEC3 position;
  uint taken;  // not 0: the point is removed
};
PALPATE_SINGLE(Brushed);

// Contribution of one point to the measured surface over the hand: the sums over all points give its position and
// orientation. Nearer points weigh more: a hand that has moved from one side of the model into another is under that
// side.
struct MeasuredPoint {
  int weight;
  ivec3 normal;  // times the weight
  int height;    // over the hand along the tool's axis, times the weight
};

PALPATE_FORMULA MeasuredPoint measured(PALPATE_OF(Brush) brush, PALPATE_OF(BrushTool) tool,
                                       PALPATE_OF(FoundPoint) found) {
  MeasuredPoint point;
  point.weight = 0;
  point.normal = ivec3(0);
  point.height = 0;
  const PALPATE_VEC3 offset = found.position - tool.hand;
  if (!(dot(found.normal, tool.outward) > Real(kTurnedAway)) || !(dot(found.normal, offset) > Real(0.0))) return point;
  const PALPATE_VEC3 scaled = offset / tool.hearing;
  const Real near = Real(1.0) - dot(scaled, scaled);
  if (!(near > Real(0.0))) return point;
  point.weight = int(Real(kWeightSteps) * (near * near) + Real(0.5));
  point.normal = point.weight * ivec3(Real(kNormalSteps) * found.normal);
  const Real height = dot(offset, tool.outward) / brush.radius;
  const Real heightInRadii = max(-Real(kMaxHeight), min(Real(kMaxHeight), height));
  point.height = point.weight * int(Real(kHeightSteps) * heightInRadii);
  return point;
}

// Whether a point is measured; dense clouds are subsampled, always to the same points.
PALPATE_FUNCTION bool isSampled(uint id, uint sampling) {
  return sampling == 0u || (id * 2654435761u) >> (32u - sampling) == 0u;
}

// Weight of a brush at a distance from its centre, 0 to 1.
PALPATE_FORMULA Real brushWeight(PALPATE_OF(Brush) brush, Real distance) {
  const Real r = distance / brush.radius;
  const Real base = Real(1.0) - r * r;
  if (!(base > Real(0.0))) return Real(0.0);
  Real weight = Real(1.0);
  for (uint k = 0u; k < brush.falloff; ++k) weight *= base;
  return weight;
}

PALPATE_FORMULA Real clampedShare(Real share) { return max(Real(0.0), min(Real(1.0), share)); }

// With symmetry a tool acts on the points that the stroke found on its own side of the plane, so that no point yields
// to both the hand and its image; those on the plane yield to the hand.
PALPATE_FORMULA Real ownHeight(PALPATE_OF(BrushTool) tool, PALPATE_VEC3 position) {
  return dot(tool.ownSide, position) - tool.ownFrom;
}
PALPATE_FORMULA bool isOnOwnSide(PALPATE_OF(BrushTool) tool, PALPATE_VEC3 position) {
  const Real height = ownHeight(tool, position);
  return height > Real(0.0) || (height == Real(0.0) && tool.isImage == 0u);
}

// A point does not cross the plane of symmetry, and one that was found on it stays on it.
PALPATE_FORMULA PALPATE_VEC3 heldOnSide(PALPATE_OF(BrushTool) tool, PALPATE_VEC3 found, PALPATE_VEC3 position) {
  const Real height = ownHeight(tool, position);
  if (height < Real(0.0) || ownHeight(tool, found) == Real(0.0)) return position - height * tool.ownSide;
  return position;
}

// Weight of a point by its normal as the stroke found it, 0 to 1.
PALPATE_FORMULA Real facingShare(PALPATE_OF(BrushTool) tool, PALPATE_VEC3 foundNormal) {
  return clampedShare((dot(foundNormal, tool.outward) - Real(kOtherSide)) / Real(kTurnedAway - kOtherSide));
}

// Share of the full effect that a point gets in this edit, by its distance from the tool's centre and its normal.
PALPATE_FORMULA Real brushShare(PALPATE_OF(Brush) brush, PALPATE_OF(BrushTool) tool, PALPATE_VEC3 position,
                                PALPATE_VEC3 foundNormal) {
  if (tool.acts == 0u || !isOnOwnSide(tool, position)) return Real(0.0);
  return tool.share * facingShare(tool, foundNormal) * brushWeight(brush, length(position - tool.center));
}

// Whether a brush acts on a side of the model: one that holds points carries both sides of a thin part along.
PALPATE_FORMULA bool isActedSide(PALPATE_OF(Brush) brush, PALPATE_OF(BrushTool) tool, PALPATE_VEC3 foundNormal) {
  return brushHas(brush, kHoldsPoints) || facingShare(tool, foundNormal) > Real(0.0);
}

// The cell in which a point is entered, in the lower bits, and over them its distance from the surface that the hand
// touches: the smallest of all names the cell of that surface. kOutsideSheet if in none: sides of the model on which
// the brush does not act do not connect what it acts on.
PALPATE_FORMULA uint entered(PALPATE_OF(Brush) brush, PALPATE_OF(BrushTool) tool, PALPATE_VEC3 position,
                             PALPATE_OF(FoundPoint) found) {
  const PALPATE_VEC3 place = sheetPlace(tool.entersFrom, tool.cell, found.position, found.normal);
  if (!isActedSide(brush, tool, found.normal) || !isInSheet(place)) return kOutsideSheet;
  PALPATE_VEC3 offset = position - tool.touched;
  if (brushHas(brush, kHoldsPoints)) offset = found.position - tool.touched;
  const Real share = min(Real(1.0), length(offset) / (Real(2.0) * tool.reach));
  return uint(Real(kSheetSteps) * share) * kSheetCells + sheetCellAt(place);
}

// The cell that must be connected with the surface under the hand if the brush is to act on the point.
PALPATE_FORMULA uint connectedCell(PALPATE_OF(BrushTool) tool, PALPATE_OF(FoundPoint) found) {
  return sheetCellAt(sheetPlace(tool.connectedFrom, tool.cell, found.position, found.normal));
}

// Position of a point after a step in one edit, no longer than a point may move in one: a point moves only as far as
// it has seen.
PALPATE_FORMULA PALPATE_VEC3 afterStep(PALPATE_OF(Brush) brush, PALPATE_VEC3 position, PALPATE_OF(FoundPoint) found,
                                       PALPATE_VEC3 step) {
  const Real size = length(step), most = min(brush.longestMove, max(Real(0.0), found.room));
  return position + (size > most ? most / size : Real(1.0)) * step;
}

// Whether the room of a point may block a step.
PALPATE_FORMULA bool mayBlock(PALPATE_OF(Brush) brush, PALPATE_OF(FoundPoint) found) {
  return brushHas(brush, kLooksAhead) && found.room < Real(kBlocks) * brush.longestMove;
}

// Whether it blocks the step of one edit. `free`: position after the step with any room.
PALPATE_FORMULA bool isBlocked(PALPATE_OF(Brush) brush, PALPATE_VEC3 position, PALPATE_OF(FoundPoint) found,
                               PALPATE_VEC3 free) {
  const Real step = length(free - position);
  return step > Real(kCountedStep) * brush.support && found.room < Real(kBlocks) * step;
}

// Rest of a displacement of which a point gets a share only: of the full one from where the stroke found it, minus
// `gone`, the part already done.
PALPATE_FORMULA Real restOfShare(Real share, Real displacement, Real gone) {
  return max(Real(0.0), displacement - (Real(1.0) - share) * (displacement + max(gone, Real(0.0))));
}

// How much of a face overhangs the surface under the hand, 0 to 1: the tool cannot press it. The ball is in it only
// because it is wider than the gap below, as between a statue's arm and its side.
PALPATE_FORMULA Real overhangShare(PALPATE_OF(Brush) brush, PALPATE_OF(BrushTool) tool, PALPATE_OF(FoundPoint) found) {
  const Real above = dot(found.position - tool.center, tool.outward) + brush.radius - tool.height;
  return clampedShare(above / (Real(kAbove) * brush.radius)) *
         clampedShare((Real(kUpright) - dot(found.normal, tool.outward)) / Real(kUpright - kOverhang));
}

// Push (thesis section 5.2). The thesis moves every point towards the proxy, which on flat ground only crowds the
// points. Here a point moves along the tool's axis to the underside of the ball: the brush leaves its shape, and points
// ahead of a moving hand are pressed down, not carried along. For a point-sized brush both are the same. In an inner
// corner the ball meets the other face with its side: that face yields along its own normal, by as much as the ball
// is in it, and no more than the face under the hand. Along the axis it would be dragged out of its place and torn.
PALPATE_FORMULA PALPATE_VEC3 pushWay(PALPATE_OF(Brush) brush, PALPATE_OF(BrushTool) tool, PALPATE_VEC3 position,
                                     PALPATE_OF(FoundPoint) found) {
  const PALPATE_VEC3 none = Real(0.0) * tool.outward;
  const Real share =
      facingShare(tool, found.normal) * (Real(1.0) - overhangShare(brush, tool, found)) * unlockedShare(found);
  if (tool.acts == 0u || !(share > Real(0.0))) return none;
  const PALPATE_VEC3 offset = position - tool.center;
  const Real height = dot(offset, tool.outward);
  const PALPATE_VEC3 aside = offset - height * tool.outward;
  const Real squared = brush.radius * brush.radius - dot(aside, aside);
  if (!(squared > Real(0.0))) return none;
  const Real chord = sqrt(squared);
  const Real depth = height + chord;
  if (height > max(tool.shaft, chord) || !(depth > Real(0.0))) return none;
  const PALPATE_VEC3 gone = found.position - position;
  PALPATE_VEC3 way = -restOfShare(share, depth, dot(gone, tool.outward)) * tool.outward;
  // What faces away slides along its own plane: straight down it would leave the solid, as under a rim.
  way -= max(Real(0.0), dot(way, found.normal)) * found.normal;
  const Real wall = clampedShare((Real(kSlope) - dot(found.normal, tool.outward)) / Real(kSlope - kWall));
  if (!(wall > Real(0.0))) return way;
  const PALPATE_VEC3 fromAxis = offset - max(Real(0.0), min(tool.shaft, height)) * tool.outward;
  const Real front = -dot(found.normal, fromAxis);
  const Real inside = max(Real(0.0), brush.radius * brush.radius - dot(fromAxis, fromAxis));
  const Real sunk = sqrt(front * front + inside) - front;
  const Real weight = wall * clampedShare(front / (Real(kInFront) * brush.radius)) *
                      clampedShare(Real(2.0) * (Real(1.0) - sunk / depth));
  return way - weight * (way + restOfShare(share, min(sunk, tool.height), dot(gone, found.normal)) * found.normal);
}

// Carve cuts the tool out of the solid. The tool's wall inside the solid is the new surface. A point that faces the
// middle of the tool has solid behind it and moves to the wall; a point that faces away does not, and is removed.
PALPATE_FORMULA PALPATE_OF(Brushed)
    carved(PALPATE_OF(Brush) brush, PALPATE_OF(BrushTool) tool, PALPATE_VEC3 position, PALPATE_VEC3 normal) {
  PALPATE_OF(Brushed) result;
  result.position = position;
  result.taken = 0u;
  const PALPATE_VEC3 offset = position - tool.center;
  const Real along = max(Real(0.0), min(tool.shaft, dot(offset, tool.outward)));
  const PALPATE_VEC3 fromAxis = offset - along * tool.outward;
  const Real distance = length(fromAxis);
  const Real depth = brush.radius - distance;
  if (tool.acts == 0u || !(depth > Real(0.0)) || !(tool.share > Real(0.0))) return result;
  PALPATE_VEC3 away = -tool.outward;
  if (distance > Real(kAtCenter) * brush.radius) away = fromAxis / distance;
  if (dot(normal, away) >= Real(0.0) || depth > Real(kCarveDepth) * brush.support) {
    result.taken = 1u;
    return result;
  }
  result.position = position + min(tool.share * depth, brush.longestMove) * away;
  return result;
}

// Flatten: moves a point towards the plane of the surface. A share that decreases with the distance from the centre
// never brings a point past another one along the axis: the flanks of a limb are lowered or raised, and not laid into
// one plane.
PALPATE_FORMULA PALPATE_VEC3 flattenWay(PALPATE_OF(BrushTool) tool, PALPATE_VEC3 position, PALPATE_OF(FoundPoint) found,
                                        Real weight) {
  const Real height = dot(found.position - tool.center, tool.outward);
  const Real side = height < Real(0.0) ? Real(-1.0) : Real(1.0);
  const Real gone = side * dot(found.position - position, tool.outward);
  const Real left = max(Real(0.0), side * weight * height - gone);
  return -tool.share * left * side * tool.outward;
}

// Inflate: moves a point along its normal, by as much as the hand presses in the whole stroke, or, if it builds up, for
// as long as the hand presses.
PALPATE_FORMULA PALPATE_VEC3 inflateWay(PALPATE_OF(Brush) brush, PALPATE_OF(BrushTool) tool, PALPATE_VEC3 position,
                                        PALPATE_OF(FoundPoint) found, Real weight) {
  const Real left = weight * tool.height - dot(position - found.position, found.normal);
  const Real step = tool.share * weight * Real(kInflateStep) * brush.radius;
  const bool endless = brushHas(brush, kBuildsUp) && tool.height > Real(0.0);
  return (endless ? step : max(Real(0.0), min(left, step))) * found.normal;
}

// Grab: moves a point along with the hand. Near a plane of symmetry the motion towards the plane or away from it
// vanishes, so that hand and image neither tear the surface nor fold it.
PALPATE_FORMULA PALPATE_VEC3 grabWay(PALPATE_OF(Brush) brush, PALPATE_OF(BrushTool) tool, PALPATE_VEC3 position,
                                     PALPATE_OF(FoundPoint) found, Real weight) {
  const Real lost = max(Real(0.0), Real(1.0) - ownHeight(tool, found.position) / brush.radius);
  const PALPATE_VEC3 motion = tool.motion - (lost * dot(tool.motion, tool.ownSide)) * tool.ownSide;
  return tool.share * ((found.position + weight * motion) - position);
}

// Position of a point after the brush, as far as it follows from the point alone; smooth also needs its neighbours
// (smoothed()), and paint does not move points.
PALPATE_FORMULA PALPATE_OF(Brushed) brushed(PALPATE_OF(Brush) brush, PALPATE_OF(BrushTool) tool, PALPATE_VEC3 position,
                                            PALPATE_VEC3 normal, PALPATE_OF(FoundPoint) found) {
  PALPATE_OF(Brushed) result;
  result.position = position;
  result.taken = 0u;
  if (tool.acts == 0u || !isOnOwnSide(tool, found.position)) return result;
  if (brush.kind == kBrushCarve) {
    if (mayBeCut(found)) return carved(brush, tool, position, normal);
    return result;
  }
  PALPATE_VEC3 way = Real(0.0) * tool.outward;
  if (brush.kind == kBrushPush) {
    way = tool.share * pushWay(brush, tool, position, found);
  } else {
    // The position as found is used, so that a point gets no more than its share in a stroke of any length.
    Real weight = unlockedShare(found) * brushWeight(brush, length(found.position - tool.center));
    if (!brushHas(brush, kHoldsPoints)) weight *= facingShare(tool, found.normal);
    if (!(weight > Real(0.0))) return result;
    if (brush.kind == kBrushFlatten) way = flattenWay(tool, position, found, weight);
    if (brush.kind == kBrushInflate) way = inflateWay(brush, tool, position, found, weight);
    if (brush.kind == kBrushGrab) way = grabWay(brush, tool, position, found, weight);
  }
  result.position = heldOnSide(tool, found.position, afterStep(brush, position, found, way));
  return result;
}

// Smooth: moves the point by a share of its distance to the algebraic sphere that the neighbours define about it
// (kSurfaceSphere), which unlike their average preserves curvature. `signedDistance`: of the point to it, model units,
// positive outside; `normal`: the sphere's.
PALPATE_FORMULA PALPATE_VEC3 smoothed(PALPATE_OF(Brush) brush, PALPATE_OF(BrushTool) tool, PALPATE_VEC3 position,
                                      PALPATE_OF(FoundPoint) found, Real signedDistance, PALPATE_VEC3 normal) {
  // Of the path from where the stroke found the point its lock leaves a share.
  const Real whole = signedDistance + dot(found.position - position, normal);
  const Real move = brushShare(brush, tool, position, found.normal) * (signedDistance - found.lock * whole);
  return afterStep(brush, position, found, -move * normal);
}

PALPATE_FORMULA uint blendedChannel(uint from, uint to, Real share, uint least) {
  const uint gap = from < to ? to - from : from - to;
  const uint wanted = max(least, uint(share * Real(gap) + Real(0.5)));
  const uint move = min(gap, wanted);
  return from < to ? from + move : from - move;
}

// Colour of a point, RGBA8 or 0 for none, after one edit of paint.
PALPATE_FORMULA uint painted(PALPATE_OF(Brush) brush, PALPATE_OF(BrushTool) tool, PALPATE_VEC3 position,
                             PALPATE_OF(FoundPoint) found, uint color) {
  const Real share = unlockedShare(found) * brushShare(brush, tool, position, found.normal);
  if (!brushHas(brush, kPaintsPoints) || !(share > Real(0.0))) return color;
  const uint from = color == 0u ? kUnpainted : color;
  // At least one level, so that a point without a lock reaches the colour.
  const uint least = found.lock > Real(0.0) ? 0u : 1u;
  uint blended = 0u;
  for (uint bit = 0u; bit < 32u; bit += 8u)
    blended |= blendedChannel((from >> bit) & 255u, (brush.color >> bit) & 255u, share, least) << bit;
  return blended;
}

PALPATE_SHARED_END
#endif
