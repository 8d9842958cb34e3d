// Slope of a depth image around a sample, without crossing a step.
#ifndef PALPATE_RENDER_DEPTH_SLOPE_GLSL
#define PALPATE_RENDER_DEPTH_SLOPE_GLSL
#include "shaders/render/view.glsl"

// Infinite outside the picture, and for the background.
float depthAt(Uints depths, uvec2 size, ivec2 at) {
  if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, ivec2(size)))) return uintBitsToFloat(kNoDepth);
  return uintBitsToFloat(depths.at[uint(at.y) * size.x + uint(at.x)]);
}

// The gentler one of the steps to both sides, since the other may lead off the surface; 0 if there is neither.
float gentlerStep(float before, float depth, float after) {
  const float back = depth - before, forth = after - depth;
  const float step = abs(back) < abs(forth) ? back : forth;
  return isinf(step) ? 0 : step;
}

// Change of depth per sample to the right and downwards.
vec2 depthSlope(Uints depths, uvec2 size, ivec2 at, float depth) {
  return vec2(gentlerStep(depthAt(depths, size, at - ivec2(1, 0)), depth, depthAt(depths, size, at + ivec2(1, 0))),
              gentlerStep(depthAt(depths, size, at - ivec2(0, 1)), depth, depthAt(depths, size, at + ivec2(0, 1))));
}

// The normal of the surface in eye space, towards the eye: the cross product of the steps to two neighbours of the von
// Neumann neighbourhood (thesis, equation 3.4).
vec3 normalOfSlope(RenderView view, ivec2 at, float depth, vec2 slope) {
  const vec2 place_px = vec2(at) + 0.5;
  const vec2 right_px = place_px + vec2(1, 0), down_px = place_px + vec2(0, 1);
  const vec3 from = rayFrom(view, place_px), here = depth * rayThrough(view, place_px);  // along the ray
  const vec3 right = (depth + slope.x) * rayThrough(view, right_px) - here + (rayFrom(view, right_px) - from);
  const vec3 down = (depth + slope.y) * rayThrough(view, down_px) - here + (rayFrom(view, down_px) - from);
  const vec3 normal = cross(right, down);
  return normalize(dot(normal, here) > 0 ? -normal : normal);
}
vec3 normalFromDepth(RenderView view, Uints depths, ivec2 at) {
  const float depth = depthAt(depths, view.size_px, at);
  return normalOfSlope(view, at, depth, depthSlope(depths, view.size_px, at, depth));
}

#endif
