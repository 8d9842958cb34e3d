#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference_uvec2 : require
// The contents of a window: a picture, and the panels over it. One invocation for each pixel.
#include "shaders/lib/index.glsl"
#include "shaders/shared/panels.h"

layout(push_constant, scalar) uniform Push { PanelComposeArgs args; };

vec3 pictureColor(uvec2 at) { return unpackUnorm4x8(args.picture.at[at.y * args.pictureWidth_px + at.x]).rgb; }

// How bright it is: integers, so that no rounding chooses between two of them.
int brightnessOf(vec3 color) {
  const ivec3 bytes = ivec3(round(255 * color));
  return 2 * bytes.r + 5 * bytes.g + bytes.b;
}

// The picture at a pixel of the window; a smaller picture is interpolated linearly in triangles between the centres of
// its pixels. Each square of four is split along the diagonal whose ends are more alike, so that edges stay sharp and
// have no steps (Su and Willis 2004, "Image interpolation by pixel-level data-dependent triangulation").
vec3 pictureAt(uvec2 pixel) {
  if (args.shrink == 1) return pictureColor(pixel);
  const uvec2 last = (args.size_px - 1) / args.shrink;
  const vec2 at = clamp((vec2(pixel) + 0.5) / args.shrink - 0.5, vec2(0), vec2(last));
  const uvec2 low = uvec2(at), high = min(low + 1, last);
  const vec2 t = at - vec2(low);
  const vec3 a = pictureColor(low), b = pictureColor(uvec2(high.x, low.y));
  const vec3 c = pictureColor(uvec2(low.x, high.y)), d = pictureColor(high);
  if (abs(brightnessOf(a) - brightnessOf(d)) < abs(brightnessOf(b) - brightnessOf(c)))
    return t.x > t.y ? a + t.x * (b - a) + t.y * (d - b) : a + t.y * (c - a) + t.x * (d - c);
  return t.x + t.y < 1 ? a + t.x * (b - a) + t.y * (c - a) : d + (1 - t.x) * (c - d) + (1 - t.y) * (b - d);
}

void main() {
  const uint place = threadIndex();
  if (place >= args.size_px.x * args.size_px.y) return;
  const uvec2 pixel = uvec2(place % args.size_px.x, place / args.size_px.x);
  const bool hasPicture = uvec2(args.picture) != uvec2(0);
  const vec3 below = hasPicture ? pictureAt(pixel) : unpackUnorm4x8(args.background).rgb;
  const uvec2 over = args.layer.at[place];
  const vec2 blueAndThrough = unpackUnorm2x16(over.y);
  const vec3 color = vec3(unpackUnorm2x16(over.x), blueAndThrough.x) + blueAndThrough.y * below;
  args.shown.at[place] = packUnorm4x8(vec4(args.blueFirst != 0 ? color.bgr : color, 1));
}
