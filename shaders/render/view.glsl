// Conversion between model units, eye space and samples of the picture.
#ifndef PALPATE_RENDER_VIEW_GLSL
#define PALPATE_RENDER_VIEW_GLSL
#include "shaders/shared/render.h"

// Rotates a direction into eye space: x right, y up, z depth.
vec3 toEye(RenderView view, vec3 direction) {
  return vec3(dot(view.right, direction), dot(view.up, direction), dot(view.forward, direction));
}
vec3 fromEye(RenderView view, vec3 direction) {
  return direction.x * view.right + direction.y * view.up + direction.z * view.forward;
}

// What lengths at a depth are divided by in the picture.
float divisorAt(RenderView view, float depth) { return view.isOrthographic != 0 ? 1 : depth; }

// Position of a point of eye space in the picture, in samples.
vec2 sampleOf(RenderView view, vec3 p) {
  return view.center_px + view.focal_px / divisorAt(view, p.z) * vec2(p.x, -p.y);
}

// The ray through a position in the picture, in eye space: where it starts, at depth 0, and its direction, of depth 1,
// so that its parameter is the depth.
vec3 rayFrom(RenderView view, vec2 place_px) {
  const vec2 offset = (place_px - view.center_px) / view.focal_px;
  return view.isOrthographic != 0 ? vec3(offset.x, -offset.y, 0) : vec3(0);
}
vec3 rayThrough(RenderView view, vec2 place_px) {
  const vec2 offset = (place_px - view.center_px) / view.focal_px;
  return view.isOrthographic != 0 ? vec3(0, 0, 1) : vec3(offset.x, -offset.y, 1);
}
vec3 pointAt(RenderView view, vec2 place_px, float depth) {
  return rayFrom(view, place_px) + depth * rayThrough(view, place_px);
}

// Direction of the ray through a point of eye space, not unit.
vec3 sightTo(RenderView view, vec3 p) { return view.isOrthographic != 0 ? vec3(0, 0, 1) : p; }

#endif
