// What a brush makes of one point of the cloud.
#ifndef PALPATE_LIB_BRUSH_REACH_GLSL
#define PALPATE_LIB_BRUSH_REACH_GLSL

#include "shaders/lib/edit_buffers.glsl"

Brush brush;
Tool tool;

void takeUpBrush(Brushes brushes, ContactStates state) {
  brush = brushes.at[0];
  const vec3 hip = state.at[0].lastHip;
  tool = toolOf(brush, hip, hip - state.at[0].motion, state.at[0].spring, state.at[0].touching);
}

PointMove stayingMove(CloudView cloud, uint slot, vec4 position, vec3 normal) {
  const uint bucket = bucketAt(cloud, position.xyz);
  return PointMove(position.xyz, floatBitsToUint(position.w), normal, kMarkRefit, slot, bucket, bucket, 0,
                   kEmptySlot);
}

// From a point that the brush moves others may come as far as from any.
void reachAnew(Tables tables, uint id) {
  const uint firstNew = tables.at[0].firstNew;
  if (id >= firstNew && uvec2(tables.at[0].reaches) != uvec2(0))
    tables.at[0].reaches.at[id - firstNew] = kReach * brush.support;
}

// What becomes of the point in a slot; false when nothing does.
bool brushedMove(CloudView cloud, Tables tables, uint slot, vec4 position, vec4 normal, out PointMove move) {
  const uint id = floatBitsToUint(position.w);
  const vec3 away = position.xyz - tool.center;
  if (tool.acts == 0 || id == kEmptySlot || dot(away, away) >= brush.toolRadius * brush.toolRadius) return false;
  move = stayingMove(cloud, slot, position, normal.xyz);
  if (normal.w == kMarkGoes) {
    move.toBucket = kNoBucket;
    return true;
  }
  if (brush.kind == kBrushSmooth) return brushShare(brush, tool, position.xyz) > 0.0;
  if (brush.kind == kBrushPaint) {
    const uint color = colorOf(tables, id);
    move.mark = kMarkGiven;
    return painted(brush, tool, position.xyz, color) != color;
  }
  const Brushed result = brushed(brush, tool, position.xyz, normal.xyz);
  if (result.taken != 0) {
    move.toBucket = kNoBucket;
    return true;
  }
  move.position = result.position;
  move.toBucket = bucketAt(cloud, result.position);
  return result.position != position.xyz;
}

#endif
