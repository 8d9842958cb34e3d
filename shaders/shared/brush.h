// What a brush does to one point in one tick. C++ and GLSL compute the same to rounding: nothing here but sums,
// products, quotients and square roots.
#ifndef PALPATE_SHARED_BRUSH_H
#define PALPATE_SHARED_BRUSH_H
#include "shaders/shared/types.h"

PALPATE_SHARED_BEGIN

// BrushKind of engine/core/brush.hpp.
const uint kBrushPush = 0;
const uint kBrushCarve = 1;
const uint kBrushInflate = 2;
const uint kBrushSmooth = 3;
const uint kBrushGrab = 4;
const uint kBrushPaint = 5;
const uint kBrushFlatten = 6;

// Of the support radius: points deeper than this in a carving ball are taken away at once. Less tears the surface where
// the hand is fast; more leaves scraps of a model that the ball has swallowed whole.
const float kCarveDepth = 2.0f;
// Of the brush's radius: how far the whole effect of inflate moves a point in one tick.
const float kInflateStep = 1e-3f;
// Of the brush's radius: nearer than this to its centre there is no way out but the tip's.
const float kAtCenter = 1e-6f;
// RGBA8, what paint finds where a point has no colour (0) yet: kUnpainted of engine/core/point_state.hpp.
const uint kUnpainted = 0xff93aac8u;

PALPATE_STRUCT(Brush) {
  uint kind;         // kBrush...
  uint falloff;      // exponent of the weight, 0 to kMostFalloff
  Real tau;          // spring length below which nothing yields, model units
  Real beta;         // push: share of the way to its target that a point goes in one tick
  Real radius;       // model units
  Real strength;     // the others: share of the whole effect in one tick
  Real longestMove;  // of one point in one tick, model units (kLongestMove)
  Real support;      // support radius, model units
  uint color;        // RGBA8
};
PALPATE_SINGLE(Brush);
PALPATE_SIZE(Brush, 36);

// The ball that acts in one tick, relative to the cloud's origin, model units.
PALPATE_STRUCT(BrushBall) {
  PALPATE_VEC3 center;
  uint acts;             // 0: nothing yields
  PALPATE_VEC3 outward;  // unit, from HIP to proxy
  PALPATE_VEC3 motion;   // of the hand since the last tick, no longer than longestMove
};
PALPATE_SINGLE(BrushBall);
PALPATE_SIZE(BrushBall, 40);

// A point after its brush.
PALPATE_STRUCT(Brushed) {
  PALPATE_VEC3 position;
  uint taken;  // not 0: the point goes away
};
PALPATE_SINGLE(Brushed);

// `spring`: from HIP to proxy; `touching`: not 0 where the proxy touches; `lastHip`: of the tick before.
PALPATE_FORMULA PALPATE_OF(BrushBall)
    ballOf(PALPATE_OF(Brush) brush, PALPATE_VEC3 hip, PALPATE_VEC3 lastHip, PALPATE_VEC3 spring, uint touching) {
  PALPATE_OF(BrushBall) ball;
  ball.center = hip;
  ball.outward = PALPATE_VEC3(Real(0.0));
  ball.motion = PALPATE_VEC3(Real(0.0));
  const Real depth = length(spring);
  ball.acts = touching != 0u && depth > brush.tau ? 1u : 0u;
  if (ball.acts == 0u) return ball;
  ball.outward = spring / depth;
  const bool standsBefore = brush.kind == kBrushPush || brush.kind == kBrushCarve;
  ball.center = standsBefore ? (hip + brush.tau * ball.outward) + brush.radius * ball.outward : hip + spring;
  const PALPATE_VEC3 motion = hip - lastHip;
  const Real way = length(motion);
  ball.motion = way > brush.longestMove ? motion * (brush.longestMove / way) : motion;
  return ball;
}

// How much a brush acts so far from the brush's centre, 0 to 1.
PALPATE_FORMULA Real brushWeight(PALPATE_OF(Brush) brush, Real distance) {
  const Real r = distance / brush.radius;
  const Real base = Real(1.0) - r * r;
  if (!(base > Real(0.0))) return Real(0.0);
  Real weight = Real(1.0);
  for (uint k = 0u; k < brush.falloff; ++k) weight *= base;
  return weight;
}

// Share of the whole effect that a point at `position` gets in this tick.
PALPATE_FORMULA Real brushShare(PALPATE_OF(Brush) brush, PALPATE_OF(BrushBall) ball, PALPATE_VEC3 position) {
  return ball.acts == 0u ? Real(0.0) : brush.strength * brushWeight(brush, length(position - ball.center));
}

// Push (thesis section 5.2): the thesis takes the proxy itself as every point's target, which on flat ground only
// crowds them; here it is the point's own place on a ball, so that the brush leaves its shape. With a brush shrunk
// to a point the two are the same.
// Carve cuts the ball out of the solid. Its wall, where it runs inside the solid, is the new surface. A point that
// faces the middle of the ball has solid behind it and goes to the wall; behind a point that faces away there is none.
PALPATE_FORMULA PALPATE_OF(Brushed)
    toBall(PALPATE_OF(Brush) brush, PALPATE_OF(BrushBall) ball, PALPATE_VEC3 position, PALPATE_VEC3 normal) {
  PALPATE_OF(Brushed) result;
  result.position = position;
  result.taken = 0u;
  const PALPATE_VEC3 fromCenter = position - ball.center;
  const Real distance = length(fromCenter);
  const Real depth = brush.radius - distance;
  if (ball.acts == 0u || !(depth > Real(0.0))) return result;
  PALPATE_VEC3 away = -ball.outward;
  if (distance > Real(kAtCenter) * brush.radius) away = fromCenter / distance;
  const bool carves = brush.kind == kBrushCarve;
  if (carves && !(brush.strength > Real(0.0))) return result;
  if (carves && (dot(normal, away) >= Real(0.0) || depth > Real(kCarveDepth) * brush.support)) {
    result.taken = 1u;
    return result;
  }
  const Real share = carves ? brush.strength : brush.beta;
  result.position = position + min(share * depth, brush.longestMove) * away;
  return result;
}

// Where a point goes by what is known of it alone; smooth needs its neighbours too (smoothed()), and paint moves
// nothing.
PALPATE_FORMULA PALPATE_OF(Brushed)
    brushed(PALPATE_OF(Brush) brush, PALPATE_OF(BrushBall) ball, PALPATE_VEC3 position, PALPATE_VEC3 normal) {
  if (brush.kind == kBrushPush || brush.kind == kBrushCarve) return toBall(brush, ball, position, normal);
  PALPATE_OF(Brushed) result;
  result.position = position;
  result.taken = 0u;
  const Real share = brushShare(brush, ball, position);
  if (!(share > Real(0.0))) return result;
  if (brush.kind == kBrushInflate)
    result.position = position + min(share * Real(kInflateStep) * brush.radius, brush.longestMove) * normal;
  if (brush.kind == kBrushFlatten) {
    const Real move = share * dot(position - ball.center, ball.outward);
    result.position = position - max(-brush.longestMove, min(brush.longestMove, move)) * ball.outward;
  }
  if (brush.kind == kBrushGrab) result.position = position + share * ball.motion;
  return result;
}

// Smooth: a share of the way to the algebraic sphere that the neighbours define about the point (kSurfaceSphere), which
// unlike their average leaves curvature alone. `signedDistance`: of the point to it, model units, positive outside;
// `normal`: the sphere's.
PALPATE_FORMULA PALPATE_VEC3 smoothed(PALPATE_OF(Brush) brush, PALPATE_OF(BrushBall) ball, PALPATE_VEC3 position,
                                      Real signedDistance, PALPATE_VEC3 normal) {
  const Real move = brushShare(brush, ball, position) * signedDistance;
  return position - max(-brush.longestMove, min(brush.longestMove, move)) * normal;
}

PALPATE_FORMULA uint blendedChannel(uint from, uint to, Real share) {
  const uint gap = from < to ? to - from : from - to;
  // A level at least, so that the colour arrives.
  const uint wanted = max(1u, uint(share * Real(gap) + Real(0.5)));
  const uint move = min(gap, wanted);
  return from < to ? from + move : from - move;
}

// The colour of a point, RGBA8 or 0 for none, after one tick of paint.
PALPATE_FORMULA uint painted(PALPATE_OF(Brush) brush, PALPATE_OF(BrushBall) ball, PALPATE_VEC3 position, uint color) {
  const Real share = brushShare(brush, ball, position);
  if (brush.kind != kBrushPaint || !(share > Real(0.0))) return color;
  const uint from = color == 0u ? kUnpainted : color;
  uint blended = 0u;
  for (uint bit = 0u; bit < 32u; bit += 8u)
    blended |= blendedChannel((from >> bit) & 255u, (brush.color >> bit) & 255u, share) << bit;
  return blended;
}

PALPATE_SHARED_END
#endif
