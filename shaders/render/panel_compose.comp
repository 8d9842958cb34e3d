#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference_uvec2 : require
// The contents of a window: a picture, and the panels over it. One invocation for each pixel.
#include "shaders/lib/index.glsl"
#include "shaders/shared/panels.h"

layout(push_constant, scalar) uniform Push { PanelComposeArgs args; };

void main() {
  const uint place = threadIndex();
  if (place >= args.size_px.x * args.size_px.y) return;
  const uvec2 seen = uvec2(place % args.size_px.x, place / args.size_px.x) / args.shrink;
  const bool hasPicture = uvec2(args.picture) != uvec2(0);
  const uint below = hasPicture ? args.picture.at[seen.y * args.pictureWidth_px + seen.x] : args.background;
  const uvec2 over = args.layer.at[place];
  const vec2 blueAndThrough = unpackUnorm2x16(over.y);
  const vec3 color = vec3(unpackUnorm2x16(over.x), blueAndThrough.x) + blueAndThrough.y * unpackUnorm4x8(below).rgb;
  args.shown.at[place] = packUnorm4x8(vec4(args.blueFirst != 0 ? color.bgr : color, 1));
}
