#version 460
#extension GL_GOOGLE_include_directive : require
// Darkens the background where it is the ground in shadow, seen from above.
#include "shaders/lib/index.glsl"
#include "shaders/render/frame_block.glsl"
#include "shaders/render/view.glsl"
#include "shaders/shared/look.h"

layout(push_constant, scalar) uniform Push { GroundArgs args; };

// 0 outside of the map.
float shadowAt(ivec2 cell) {
  const int cells = int(args.map.cells);
  if (any(lessThan(cell, ivec2(0))) || any(greaterThanEqual(cell, ivec2(cells)))) return 0;
  return args.shadow.at[cell.y * cells + cell.x];
}

void main() {
  const RenderView view = frame.view;
  const uint place = threadIndex();
  if (place >= view.size_px.x * view.size_px.y || args.depth.at[args.source.at[place]] != kNoDepth) return;
  const vec2 place_px = vec2(place % view.size_px.x, place / view.size_px.x) + 0.5;
  const vec3 ray = fromEye(view, rayThrough(view, place_px));
  const vec3 from = view.eye - args.map.corner + fromEye(view, rayFrom(view, place_px));
  const float height = dot(from, args.map.up), falling = -dot(ray, args.map.up);
  // Rays of an orthographic camera also come from before the depth 0.
  if (!((height > 0 || view.isOrthographic != 0) && falling > 0)) return;
  const vec3 onGround = from + height / falling * ray;
  const vec2 cell = vec2(dot(onGround, args.map.along), dot(onGround, args.map.across)) / args.map.cell;
  const float side = float(args.map.cells), border = min(min(cell.x, side - cell.x), min(cell.y, side - cell.y));
  if (!(border > 0)) return;
  const ivec2 low = ivec2(floor(cell - 0.5));
  const vec2 t = cell - 0.5 - vec2(low);
  const float shadow = mix(mix(shadowAt(low), shadowAt(low + ivec2(1, 0)), t.x),
                           mix(shadowAt(low + ivec2(0, 1)), shadowAt(low + 1), t.x), t.y);
  const float factor = 1 - kGroundStrength * shadow * smoothstep(0.0, kGroundFade * side, border);
  const uvec2 packed = args.shaded.at[place];
  const vec2 blueAndOpacity = unpackHalf2x16(packed.y);
  const vec3 light = factor * vec3(unpackHalf2x16(packed.x), blueAndOpacity.x);
  const float opacity = 1 - (1 - blueAndOpacity.y) * factor;  // black over whatever is behind the picture
  args.shaded.at[place] = uvec2(packHalf2x16(light.rg), packHalf2x16(vec2(light.b, opacity)));
}
