#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference_uvec2 : require
// Lowest and highest point above each cell of the ground.
#include "shaders/lib/index.glsl"
#include "shaders/render/shown.glsl"
#include "shaders/shared/look.h"

layout(push_constant, scalar) uniform Push { GroundHeightsArgs args; };

void main() {
  const uint point = threadIndex();
  if (point >= args.map.count) return;
  const bool isMesh = uvec2(args.positions) == uvec2(0);
  if (uvec2(args.hidden) != uvec2(0) && isIn(args.hidden.at[point / 32], point)) return;
  const vec3 position = isMesh ? args.vertices.at[args.triangles.at[point]].position : args.positions.at[point].xyz;
  const vec3 from = position - args.map.corner;
  const vec2 cell = floor(vec2(dot(from, args.map.along), dot(from, args.map.across)) / args.map.cell);
  // Positions that are not numbers are in no cell.
  if (!(all(greaterThanEqual(cell, vec2(0))) && all(lessThan(cell, vec2(args.map.cells))))) return;
  const uint place = uint(cell.y) * args.map.cells + uint(cell.x);
  const uint height = floatBitsToUint(max(dot(from, args.map.up), 0.0));
  const uint high = args.map.cells * args.map.cells + place;
  // The plain read may be stale, which costs an addition at most: many points share a cell.
  if (args.heights.at[place] > height) atomicMin(args.heights.at[place], height);
  if (args.heights.at[high] < height) atomicMax(args.heights.at[high], height);
}
