// What a brush makes of one point of the cloud.
#ifndef PALPATE_LIB_BRUSH_REACH_GLSL
#define PALPATE_LIB_BRUSH_REACH_GLSL

#include "shaders/lib/list_moves.glsl"

Brush brush;
BrushBall ball;

void takeUpBrush(Brushes brushes, ContactStates state) {
  brush = brushes.at[0];
  const vec3 hip = state.at[0].lastHip;
  ball = ballOf(brush, hip, hip - state.at[0].motion, state.at[0].spring, state.at[0].touching);
}

PointMove stayingMove(uint slot, vec4 position, vec3 normal) {
  const uint bucket = bucketAt(position.xyz);
  return PointMove(position.xyz, floatBitsToUint(position.w), normal, kMarkRefit, slot, bucket, bucket, 0,
                   kEmptySlot);
}

// From a point that the brush moves others may come as far as from any.
void resetReach(uint id) {
  const uint firstNew = args.tables.at[0].firstNew;
  if (id >= firstNew && uvec2(args.tables.at[0].reaches) != uvec2(0))
    args.tables.at[0].reaches.at[id - firstNew] = kReach * brush.support;
}

// What becomes of the point in a slot; false when nothing does.
bool brushedMove(uint slot, vec4 position, vec4 normal, out PointMove move) {
  const uint id = floatBitsToUint(position.w);
  const vec3 away = position.xyz - ball.center;
  if (ball.acts == 0 || id == kEmptySlot || dot(away, away) >= brush.radius * brush.radius) return false;
  move = stayingMove(slot, position, normal.xyz);
  if (normal.w == kMarkGoes) {
    move.toBucket = kNoBucket;
    return true;
  }
  if (brush.kind == kBrushSmooth) return brushShare(brush, ball, position.xyz) > 0.0;
  if (brush.kind == kBrushPaint) {
    const uint color = colorOf(args.tables, id);
    move.mark = kMarkGiven;
    return painted(brush, ball, position.xyz, color) != color;
  }
  const Brushed result = brushed(brush, ball, position.xyz, normal.xyz);
  if (result.taken != 0) {
    move.toBucket = kNoBucket;
    return true;
  }
  move.position = result.position;
  move.toBucket = bucketAt(result.position);
  return result.position != position.xyz;
}

#endif
