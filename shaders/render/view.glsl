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

// Position of a point of eye space in the picture, in samples.
vec2 sampleOf(RenderView view, vec3 p) { return view.center_px + view.focal_px / p.z * vec2(p.x, -p.y); }

// The ray through a position in the picture, in eye space, of depth 1: times a depth it gives the point there.
vec3 rayThrough(RenderView view, vec2 place_px) {
  const vec2 offset = (place_px - view.center_px) / view.focal_px;
  return vec3(offset.x, -offset.y, 1);
}

#endif
