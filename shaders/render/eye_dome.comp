#version 460
#extension GL_GOOGLE_include_directive : require
// Eye-dome light (Boucheny 2009, "Interactive scientific visualization of large datasets", chapter 3): a sample darkens
// by how much nearer the samples around it are. Requires no normals, so it shapes bare points and unlit colours.
// Samples on opposite sides count together, so that a plane keeps its colour, however it is tilted.
#include "shaders/lib/index.glsl"
#include "shaders/render/frame_block.glsl"
#include "shaders/render/view.glsl"
#include "shaders/shared/look.h"

layout(push_constant, scalar) uniform Push { EyeDomeArgs args; };

const float kPerLog2 = 1.442695;  // of a small change by a factor

// How steeply the surface comes nearer towards a sample beside `at`, per pixel's width at its depth; 0 if nothing is
// there.
float rise(RenderView view, float depth, ivec2 at, ivec2 way) {
  const ivec2 there = at + way;
  if (any(lessThan(there, ivec2(0))) || any(greaterThanEqual(there, ivec2(view.size_px)))) return 0;
  const uint bits = args.depth.at[args.source.at[uint(there.y) * view.size_px.x + uint(there.x)]];
  const float other = uintBitsToFloat(bits);
  const float ratio = view.isOrthographic != 0 ? kPerLog2 * (depth - other) : log2(depth / other);
  const float slope = ratio * view.focal_px / float(max(abs(way.x), abs(way.y)));
  return bits == kNoDepth ? 0 : clamp(slope, -kEyeDomeSteepest, kEyeDomeSteepest);
}

const ivec2 kWays[4] = ivec2[4](ivec2(1, 0), ivec2(1, 1), ivec2(0, 1), ivec2(-1, 1));

void main() {
  const RenderView view = frame.view;
  const uint place = threadIndex();
  if (place >= view.size_px.x * view.size_px.y) return;
  const uint bits = args.depth.at[args.source.at[place]];
  if (bits == kNoDepth) return;
  const ivec2 at = ivec2(place % view.size_px.x, place / view.size_px.x);
  const float depth = uintBitsToFloat(bits);
  float sum = 0;
  for (uint ring = 1; ring <= kEyeDomeRings; ++ring) {
    const float wanted_px = kEyeDomeWidest_px * float(view.supersample) * float(ring) / float(kEyeDomeRings);
    const int radius_px = max(int(round(wanted_px)), 1);
    for (int k = 0; k < 4; ++k)
      sum += max(rise(view, depth, at, radius_px * kWays[k]) + rise(view, depth, at, -radius_px * kWays[k]), 0);
  }
  const float factor = exp(-kEyeDomeStrength * sum / float(4 * kEyeDomeRings));
  const uvec2 packed = args.shaded.at[place];
  const vec3 light = factor * vec3(unpackHalf2x16(packed.x), unpackHalf2x16(packed.y).x);
  args.shaded.at[place] = uvec2(packHalf2x16(light.rg), packHalf2x16(vec2(light.b, 1)));
}
