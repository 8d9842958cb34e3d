// What a brush does to one point in one tick. C++ and GLSL compute the same to rounding: nothing here but sums,
// products, quotients and square roots. In double precision: engine/edit/brush_reference.hpp.
#ifndef PALPATE_SHARED_BRUSH_H
#define PALPATE_SHARED_BRUSH_H
#include "shaders/shared/types.h"

#ifdef __cplusplus
#include <glm/geometric.hpp>
#endif

PALPATE_SHARED_BEGIN

#ifdef __cplusplus
using glm::dot;
using glm::length;
using glm::max;
using glm::min;
#endif

// BrushKind of engine/core/brush.hpp.
const uint kBrushPush = 0;
const uint kBrushCarve = 1;
const uint kBrushInflate = 2;
const uint kBrushSmooth = 3;
const uint kBrushGrab = 4;
const uint kBrushPaint = 5;

// Of the support radius: points deeper than this in a carving ball are taken away at once. Less tears the surface where
// the hand is fast; more leaves scraps of a model that the ball has swallowed whole.
const float kCarveDepth = 2.0f;
// Of the tool's radius: how far the whole effect of inflate moves a point in one tick.
const float kInflateStep = 1e-3f;
// Of the tool's radius: nearer than this to its centre there is no way out but the tip's.
const float kAtCenter = 1e-6f;
// RGBA8, what paint finds where a point has no colour (0) yet: kUnpainted of engine/core/point_state.hpp.
const uint kUnpainted = 0xff93aac8u;

struct Brush {
  uint kind;          // kBrush...
  uint falloff;       // exponent of the weight, 0 to kMostFalloff
  float tau;          // spring length below which nothing yields, model units
  float beta;         // push: share of the way to its target that a point goes in one tick
  float toolRadius;   // model units
  float strength;     // the others: share of the whole effect in one tick
  float longestMove;  // of one point in one tick, model units (kLongestMove)
  float support;      // support radius, model units
  uint color;         // RGBA8
};
PALPATE_SIZE(Brush, 36);

// The ball that acts in one tick, relative to the cloud's origin, model units.
struct Tool {
  vec3 center;
  uint acts;     // 0: nothing yields
  vec3 outward;  // unit, from HIP to proxy
  vec3 motion;   // of the hand since the last tick, no longer than longestMove
};
PALPATE_SIZE(Tool, 40);

// A point after its brush.
struct Brushed {
  vec3 position;
  uint taken;  // not 0: the point goes away
};

// `spring`: from HIP to proxy; `touching`: not 0 where the proxy touches; `lastHip`: of the tick before.
PALPATE_FUNCTION Tool toolOf(Brush brush, vec3 hip, vec3 lastHip, vec3 spring, uint touching) {
  Tool tool;
  tool.center = hip;
  tool.outward = vec3(0.0f);
  tool.motion = vec3(0.0f);
  const float depth = length(spring);
  tool.acts = touching != 0u && depth > brush.tau ? 1u : 0u;
  if (tool.acts == 0u) return tool;
  tool.outward = spring / depth;
  const bool standsBefore = brush.kind == kBrushPush || brush.kind == kBrushCarve;
  tool.center = standsBefore ? (hip + brush.tau * tool.outward) + brush.toolRadius * tool.outward : hip + spring;
  const vec3 motion = hip - lastHip;
  const float way = length(motion);
  tool.motion = way > brush.longestMove ? motion * (brush.longestMove / way) : motion;
  return tool;
}

// How much a brush acts so far from the tool's centre, 0 to 1.
PALPATE_FUNCTION float brushWeight(Brush brush, float distance) {
  const float r = distance / brush.toolRadius;
  const float base = 1.0f - r * r;
  if (!(base > 0.0f)) return 0.0f;
  float weight = 1.0f;
  for (uint k = 0u; k < brush.falloff; ++k) weight *= base;
  return weight;
}

// Share of the whole effect that a point at `position` gets in this tick.
PALPATE_FUNCTION float brushShare(Brush brush, Tool tool, vec3 position) {
  return tool.acts == 0u ? 0.0f : brush.strength * brushWeight(brush, length(position - tool.center));
}

// Push (thesis section 5.2): the thesis takes the proxy itself as every point's target, which on flat ground only
// crowds them; here it is the point's own place on a round tool, so that the tool leaves its shape. With a tool shrunk
// to a point the two are the same.
// Carve cuts the ball out of the solid. Its wall, where it runs inside the solid, is the new surface. A point that
// faces the middle of the ball has solid behind it and goes to the wall; behind a point that faces away there is none.
PALPATE_FUNCTION Brushed toBall(Brush brush, Tool tool, vec3 position, vec3 normal) {
  Brushed result;
  result.position = position;
  result.taken = 0u;
  const vec3 fromCenter = position - tool.center;
  const float distance = length(fromCenter);
  const float depth = brush.toolRadius - distance;
  if (tool.acts == 0u || !(depth > 0.0f)) return result;
  vec3 away = -tool.outward;
  if (distance > kAtCenter * brush.toolRadius) away = fromCenter / distance;
  const bool carves = brush.kind == kBrushCarve;
  if (carves && !(brush.strength > 0.0f)) return result;
  if (carves && (dot(normal, away) >= 0.0f || depth > kCarveDepth * brush.support)) {
    result.taken = 1u;
    return result;
  }
  const float share = carves ? brush.strength : brush.beta;
  result.position = position + min(share * depth, brush.longestMove) * away;
  return result;
}

// Where a point goes by what is known of it alone; smooth needs its neighbours too (smoothed()), and paint moves
// nothing.
PALPATE_FUNCTION Brushed brushed(Brush brush, Tool tool, vec3 position, vec3 normal) {
  if (brush.kind == kBrushPush || brush.kind == kBrushCarve) return toBall(brush, tool, position, normal);
  Brushed result;
  result.position = position;
  result.taken = 0u;
  const float share = brushShare(brush, tool, position);
  if (!(share > 0.0f)) return result;
  if (brush.kind == kBrushInflate)
    result.position = position + min(share * kInflateStep * brush.toolRadius, brush.longestMove) * normal;
  if (brush.kind == kBrushGrab) result.position = position + share * tool.motion;
  return result;
}

// Smooth: a share of the way to the algebraic sphere that the neighbours define about the point (kSurfaceSphere), which
// unlike their average leaves curvature alone. `signedDistance`: of the point to it, model units, positive outside;
// `normal`: the sphere's.
PALPATE_FUNCTION vec3 smoothed(Brush brush, Tool tool, vec3 position, float signedDistance, vec3 normal) {
  const float move = brushShare(brush, tool, position) * signedDistance;
  return position - max(-brush.longestMove, min(brush.longestMove, move)) * normal;
}

PALPATE_FUNCTION uint blendedChannel(uint from, uint to, float share) {
  const uint gap = from < to ? to - from : from - to;
  // A level at least, so that the colour arrives.
  const uint wanted = max(1u, uint(share * float(gap) + 0.5f));
  const uint move = min(gap, wanted);
  return from < to ? from + move : from - move;
}

// The colour of a point, RGBA8 or 0 for none, after one tick of paint.
PALPATE_FUNCTION uint painted(Brush brush, Tool tool, vec3 position, uint color) {
  const float share = brushShare(brush, tool, position);
  if (brush.kind != kBrushPaint || !(share > 0.0f)) return color;
  const uint from = color == 0u ? kUnpainted : color;
  uint blended = 0u;
  for (uint bit = 0u; bit < 32u; bit += 8u)
    blended |= blendedChannel((from >> bit) & 255u, (brush.color >> bit) & 255u, share) << bit;
  return blended;
}

PALPATE_SHARED_END
#endif
