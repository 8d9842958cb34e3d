// What a point sees ahead on the path along which a brush moves it, and how far it may go on: C++ and GLSL share these.
#ifndef PALPATE_SHARED_LOOK_AHEAD_H
#define PALPATE_SHARED_LOOK_AHEAD_H
#include "shaders/shared/brush.h"

PALPATE_SHARED_BEGIN

// In spacings of a point: it stops this far before what lies ahead, and looks this far to the sides of its path.
const float kStopMargin = 1.0f, kStopBeside = 2.0f;
// In neighbourhood radii: how far a point may move if nothing lies ahead, until it looks again.
const float kFreeAhead = 0.5f;
// Something ahead that moves along with a point is not in its way: below this share of the point's motion that it
// lacks.
const float kLags = 0.5f;
// Cosine between a path and the normal of a surface above which the path meets the surface.
const float kMeets = 0.2f;
// Cosine between a path and the normal of its own point, negated, below which the point slides along its surface.
const float kSlides = 0.01f;
// Cosine between the normals of the two sides of a thin part, at most.
const float kOpposite = -0.5f;
// A point goes no further ahead of a blocked one beside it than this share of their distance, as the stroke found them,
// and this many spacings.
const float kBlockedSlope = 0.25f, kBlockedMargin = 0.25f;
// Cosine between the normals of two such points on one side, at least.
const float kOneSide = 0.3f;

// The direction in which a brush moves a point, unit; zero for none.
PALPATE_FORMULA PALPATE_VEC3 directionOf(PALPATE_OF(Brush) brush, PALPATE_OF(BrushTool) tool, PALPATE_VEC3 position,
                                         PALPATE_OF(FoundPoint) found) {
  if (brush.kind == kBrushPush) {
    const PALPATE_VEC3 way = pushWay(brush, tool, position, found);
    const Real far = length(way);
    return far > Real(kAtCenter) * brush.radius ? way / far : -tool.outward;
  }
  if (brushHas(brush, kFollowsNormals)) return brushHas(brush, kRaisesSurface) ? found.normal : -found.normal;
  if (brush.kind == kBrushFlatten)
    return (dot(found.position - tool.center, tool.outward) > Real(0.0) ? Real(-1.0) : Real(1.0)) * tool.outward;
  const Real size = length(tool.motion);
  return brushHas(brush, kHoldsPoints) && size > Real(0.0) ? tool.motion / size : Real(0.0) * tool.motion;
}

// What a point sees of another one: `offset` away, with this unit normal. `moves`: the brush acts on the other one, or
// does not reach it.
PALPATE_STRUCT(SeenPoint) {
  PALPATE_VEC3 offset;
  PALPATE_VEC3 normal;
  bool moves;
};
PALPATE_SINGLE(SeenPoint);

// How much less than a point the brush moves the other one: 0 if both move alike, 2 if they move towards each other.
PALPATE_FORMULA Real lagOf(PALPATE_OF(Brush) brush, PALPATE_OF(BrushTool) tool, PALPATE_OF(SeenPoint) seen) {
  if (!seen.moves) return Real(1.0);
  if (brushHas(brush, kFollowsNormals)) return Real(brushHas(brush, kRaisesSurface) ? 2.0 : 1.0);
  // What the hand holds moves by weights that cannot fold it: BrushStroke::held().
  if (brushHas(brush, kHoldsPoints)) return Real(0.0);
  return Real(1.0) - facingShare(tool, seen.normal);
}

// How far in front of a face the tool is, which presses it or is behind it: the ball and its shaft, or over a plane.
PALPATE_FORMULA Real inFrontOf(PALPATE_OF(Brush) brush, PALPATE_OF(BrushTool) tool, PALPATE_VEC3 position,
                               PALPATE_VEC3 normal) {
  const PALPATE_VEC3 offset = tool.center - position;
  if (!brushHas(brush, kHasShaft)) return dot(normal, offset + brush.radius * tool.outward);
  const Real along = max(Real(0.0), min(tool.shaft, -dot(offset, tool.outward)));
  return dot(normal, offset + along * tool.outward);
}

// What a moving point looks for on its path.
PALPATE_STRUCT(Path) {
  PALPATE_VEC3 direction;    // unit; zero: no path
  PALPATE_VEC3 position;     // of the point
  PALPATE_VEC3 back;         // from there to where the stroke found it
  PALPATE_VEC3 foundNormal;  // unit
  Real spacing;              // of the point, model units
  bool pressed;              // a tool that presses is in front of the point's face
  bool isBehind;             // it is behind the face, which may be the far side of a thin part
};
PALPATE_SINGLE(Path);

PALPATE_FORMULA PALPATE_OF(Path) pathOf(PALPATE_OF(Brush) brush, PALPATE_OF(BrushTool) tool, PALPATE_VEC3 position,
                                        PALPATE_OF(FoundPoint) found, Real spacing) {
  PALPATE_OF(Path) path;
  path.direction = directionOf(brush, tool, position, found);
  path.position = position;
  path.back = found.position - position;
  path.foundNormal = found.normal;
  path.spacing = spacing;
  const bool presses = brushHas(brush, kPressesFaces);
  path.pressed = presses && inFrontOf(brush, tool, found.position, found.normal) > Real(0.0);
  path.isBehind = presses && !path.pressed;
  return path;
}

// Whether a point `offset` away may limit a path.
PALPATE_FORMULA bool isBeside(PALPATE_OF(Path) path, PALPATE_VEC3 offset) {
  const Real along = dot(offset, path.direction), beside = Real(kStopBeside) * path.spacing;
  const PALPATE_VEC3 aside = offset - along * path.direction;
  return path.isBehind || (along > Real(0.0) && dot(aside, aside) < beside * beside);
}

// Whether a point is on the far side of a thin part of whose near side, which the tool presses, it sees a point.
PALPATE_FORMULA bool isFarSide(PALPATE_OF(Brush) brush, PALPATE_OF(BrushTool) tool, PALPATE_OF(Path) path,
                               PALPATE_OF(SeenPoint) seen) {
  const PALPATE_VEC3 offset = seen.offset - path.back;
  const Real over = dot(offset, path.foundNormal), beside = Real(kStopBeside) * path.spacing;
  const PALPATE_VEC3 aside = offset - over * path.foundNormal;
  return path.isBehind && over < Real(0.0) && dot(aside, aside) < beside * beside &&
         dot(seen.normal, path.foundNormal) < Real(kOpposite) &&
         inFrontOf(brush, tool, path.position + seen.offset, seen.normal) > Real(0.0);
}

// How far a point may go on its path, at most `free`, until it comes within a margin of the surface at another point,
// which isBeside(), if that stays behind.
PALPATE_FORMULA Real freeUntil(PALPATE_OF(Brush) brush, PALPATE_OF(BrushTool) tool, PALPATE_OF(Path) path,
                               PALPATE_OF(SeenPoint) seen, Real free) {
  if (isFarSide(brush, tool, path, seen)) return Real(0.0);
  const Real along = dot(seen.offset, path.direction), beside = Real(kStopBeside) * path.spacing;
  const PALPATE_VEC3 aside = seen.offset - along * path.direction;
  if (!(along > Real(0.0)) || !(dot(aside, aside) < beside * beside)) return free;
  Real lag = lagOf(brush, tool, seen);
  // The far side of a thin part stays: isFarSide(), as seen from there.
  if (path.pressed && dot(seen.normal, path.foundNormal) < Real(kOpposite)) lag = Real(1.0);
  if (lag < Real(kLags)) return free;
  const bool enters = dot(path.foundNormal, path.direction) < -Real(kSlides);
  const Real slope = dot(seen.normal, path.direction), margin = Real(kStopMargin) * path.spacing;
  if (enters ? slope > Real(kMeets) : slope < -Real(kMeets))
    return min(free, max(Real(0.0), dot(seen.offset, seen.normal) / slope - margin) / lag);
  // A rim does not pass a side that stays.
  if (!enters && slope > Real(kMeets) && brushHas(brush, kPressesFaces)) return min(free, along / lag);
  if (seen.moves || !(slope < -Real(kMeets))) return free;
  // A surface that faces the same way is the point's own, unless it was well ahead where the stroke found the point.
  const Real before = dot(seen.offset - path.back, seen.normal) / slope;
  return before > Real(2.0) * margin ? min(free, max(Real(0.0), dot(seen.offset, seen.normal) / slope - margin)) : free;
}

// How far a point may go on its path, at most `free`, beside a blocked point on its own side: `offset` away, found by
// the stroke `back` from there, with this normal. So a side that stays holds up what has nothing below it, as at a rim.
PALPATE_FORMULA Real freeBeside(PALPATE_OF(Brush) brush, PALPATE_OF(Path) path, PALPATE_VEC3 offset, PALPATE_VEC3 back,
                                PALPATE_VEC3 foundNormal, Real free) {
  // What the hand holds keeps its shape by its weights.
  if (brushHas(brush, kHoldsPoints) || !(dot(foundNormal, path.foundNormal) > Real(kOneSide))) return free;
  const PALPATE_VEC3 apart = offset + back - path.back;  // as found
  const Real most = Real(kBlockedSlope) * length(apart) + Real(kBlockedMargin) * path.spacing;
  return min(free, max(Real(0.0), most - dot(back - path.back, path.direction)));
}

// Whether freeUntil() changes nothing between points with normals for which this holds, if the brush moves them all.
PALPATE_FORMULA bool isInNoWay(PALPATE_OF(Brush) brush, PALPATE_OF(BrushTool) tool, PALPATE_VEC3 normal) {
  if (brushHas(brush, kFollowsNormals)) return dot(normal, tool.outward) > Real(0.7072);
  return brushHas(brush, kHoldsPoints) || dot(normal, tool.outward) > Real(0.5);
}

PALPATE_SHARED_END
#endif
