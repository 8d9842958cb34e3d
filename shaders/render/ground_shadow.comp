#version 460
#extension GL_GOOGLE_include_directive : require
// The share of an even sky that the columns above the map hide from each of its cells. In each direction the columns
// hide the elevations from the lowest to the highest that one of them reaches; between the elevations a and b is
// sin^2 b - sin^2 a of the light on the ground. What is high above casts a soft shadow, and what stands on the ground a
// dark one close to it. One invocation for each direction of a cell, which keeps each of them short.
#include "shaders/lib/index.glsl"
#include "shaders/render/pattern.glsl"
#include "shaders/shared/look.h"

layout(push_constant, scalar) uniform Push { GroundShadowArgs args; };

void main() {
  const uint cells = args.map.cells, place = threadIndex() / kGroundDirections;
  if (place >= cells * cells) return;
  const ivec2 at = ivec2(place % cells, place / cells);
  const float number = float(threadIndex() % kGroundDirections) + (float(rankOf(at)) + 0.5) / 16;
  const float angle = 6.2831853 * number / float(kGroundDirections);
  const vec2 along = vec2(cos(angle), sin(angle));
  float low = 1, high = 0;  // sin^2 of elevations
  for (uint step = 0; step < 2 * cells; ++step) {
    const ivec2 there = ivec2(round(vec2(at) + float(step) * along));
    if (any(lessThan(there, ivec2(0))) || any(greaterThanEqual(there, ivec2(cells)))) break;
    const uint index = uint(there.y) * cells + uint(there.x);
    const uint bits = args.heights.at[index];
    if (bits == kNoDepth) continue;
    const float bottom = uintBitsToFloat(bits), top = uintBitsToFloat(args.heights.at[cells * cells + index]);
    const float away = max(float(step), 0.5) * args.map.cell;
    low = min(low, bottom * bottom / (bottom * bottom + away * away));
    // Its own column goes up to the zenith.
    high = max(high, step == 0 ? 1 : top * top / (top * top + away * away));
  }
  if (high > low) atomicAdd(args.rough.at[place], uint(round(kGroundUnit * (high - low))));
}
