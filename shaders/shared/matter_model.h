// A model at rest in matter, closed and rigid, as a field on the nodes of a lattice: the share of all weight around a
// position that is inside the model (density maps; Koschier, Bender 2017), and the distance of its surface. Both are
// trilinear between nodes, and the slope of the share is that of the interpolated value, so that its pushes are the
// slope of an energy, too.
#ifndef PALPATE_SHARED_MATTER_MODEL_H
#define PALPATE_SHARED_MATTER_MODEL_H
#include "shaders/shared/matter.h"
#include "shaders/shared/types.h"

PALPATE_SHARED_BEGIN

// A node holds the values along x at itself and at the next one: the share at both, then the distance at both.
struct ModelField {
  vec3 corner;  // the node at 0, m
  float nodesPerMetre;
  ivec3 nodes;    // along each axis; 0: no model
  float nearest;  // minimum distance of a particle from its surface, m
};
PALPATE_SIZE(ModelField, 32);

// The nodes around a position.
struct ModelCell {
  ivec3 node;  // the lowest
  vec3 part;   // of the distance to the next ones
  bool isOutside;
};

PALPATE_FUNCTION ModelCell modelCell(ModelField field, vec3 place) {
  const vec3 along = (place - field.corner) * field.nodesPerMetre;
  ModelCell cell;
  // Written so that a NaN is outside.
  cell.isOutside = !(along.x >= 0.0f && along.y >= 0.0f && along.z >= 0.0f && along.x < float(field.nodes.x - 1) &&
                     along.y < float(field.nodes.y - 1) && along.z < float(field.nodes.z - 1));
  cell.node = cell.isOutside ? ivec3(0) : ivec3(along);
  cell.part = cell.isOutside ? vec3(0.0f) : along - vec3(cell.node);
  return cell;
}
PALPATE_FUNCTION uint modelNode(ModelField field, ivec3 node) {
  return uint((node.z * field.nodes.y + node.y) * field.nodes.x + node.x);
}

// The model at a position.
struct ModelAt {
  float share;     // of all weight
  float distance;  // from its surface, below 0 inside, m
  vec3 slope;      // of the share, away from the model, 1 / m
  vec3 outwards;   // unit, or 0 where the distance has no slope
};

PALPATE_FUNCTION float between(float a, float b, float part) { return a + part * (b - a); }

// The slope along the three axes, per node, and the value, from the beginnings and the ends of four rows along x; y
// varies fastest.
PALPATE_FUNCTION vec4 trilinear(vec4 begins, vec4 ends, vec3 part) {
  const vec4 steps = ends - begins, rows = begins + part.x * steps;
  const float low = between(rows.x, rows.y, part.y), high = between(rows.z, rows.w, part.y);
  const float along = between(between(steps.x, steps.y, part.y), between(steps.z, steps.w, part.y), part.z);
  return vec4(along, between(rows.y - rows.x, rows.w - rows.z, part.z), high - low, between(low, high, part.z));
}

// `a` to `d`: the nodes at the low end of the four rows around the position.
PALPATE_FUNCTION ModelAt modelAt(ModelField field, vec3 part, vec4 a, vec4 b, vec4 c, vec4 d) {
  const vec4 share = trilinear(vec4(a.x, b.x, c.x, d.x), vec4(a.y, b.y, c.y, d.y), part);
  const vec4 away = trilinear(vec4(a.z, b.z, c.z, d.z), vec4(a.w, b.w, c.w, d.w), part);
  const vec3 rises = vec3(away.x, away.y, away.z);
  const float steep = length(rises);
  ModelAt at;
  at.share = share.w;
  at.distance = away.w;
  at.slope = -field.nodesPerMetre * vec3(share.x, share.y, share.z);
  at.outwards = steep > 0.0f ? rises / steep : vec3(0.0f);
  return at;
}
PALPATE_FUNCTION ModelAt noModel() {
  ModelAt at;
  at.share = 0.0f;
  at.distance = 1e30f;
  at.slope = vec3(0.0f);
  at.outwards = vec3(0.0f);
  return at;
}

// Displacement that keeps a particle at least `nearest` from the surface.
PALPATE_FUNCTION vec3 keptOut(ModelField field, ModelAt at) {
  return max(field.nearest - at.distance, 0.0f) * at.outwards;
}

// Contact of a ball held by a hand with the model: the ball leaves the model at once, and does not move further into
// it.
struct StoppedBall {
  vec3 move;    // m
  vec3 change;  // of its velocity, m/s
};
PALPATE_FUNCTION StoppedBall stoppedBall(ModelAt at, float radius, vec3 velocity) {
  const float deep = radius - at.distance;
  StoppedBall stopped;
  stopped.move = max(deep, 0.0f) * at.outwards;
  stopped.change = deep > 0.0f ? -min(dot(velocity, at.outwards), 0.0f) * at.outwards : vec3(0.0f);
  return stopped;
}

// Effect of the model on a particle of water, as a curved wall: the inside holds the same matter, at rest density.
// Where it meets walls, shares are combined as if they were independent.
PALPATE_FUNCTION WallEffect modelEffect(WaterRules rules, ModelAt at, WallEffect walls) {
  const float open = 1.0f - walls.sum / rules.wallSum;
  WallEffect effect;
  effect.sum = rules.wallSum * open * at.share;
  effect.slope = rules.support * open * at.slope;
  effect.drag = length(effect.slope) / max(at.distance, rules.nearest);
  return effect;
}
// The remaining effect of the walls next to the model.
PALPATE_FUNCTION WallEffect wallsBesideModel(WallEffect walls, ModelAt at) {
  const float open = 1.0f - at.share;
  WallEffect effect;
  effect.sum = open * walls.sum;
  effect.slope = open * walls.slope;
  effect.drag = open * walls.drag;
  return effect;
}

PALPATE_SHARED_END
#endif
