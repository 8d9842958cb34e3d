#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference_uvec2 : require
// The contents of a window: a picture, and the panels over it. One invocation for each square of `shrink` x `shrink`
// pixels that lie between the same pixels of the picture.
#include "shaders/lib/index.glsl"
#include "shaders/shared/panels.h"

layout(push_constant, scalar) uniform Push { PanelComposeArgs args; };

vec3 pictureColor(uvec2 at) { return unpackUnorm4x8(args.picture.at[at.y * args.pictureWidth_px + at.x]).rgb; }

// How bright it is: integers, so that no rounding chooses between two of them.
int brightnessOf(vec3 color) {
  const ivec3 bytes = ivec3(round(255 * color));
  return 2 * bytes.r + 5 * bytes.g + bytes.b;
}

// Four pixels of the picture, and between them one linear function on each side of a diagonal: that whose ends are more
// alike, so that edges stay sharp and have no steps (Su and Willis 2004, "Image interpolation by pixel-level
// data-dependent triangulation").
struct Square {
  uvec2 low;
  vec3 a, b, c, d;  // left and right, upper, then lower
  bool falls;       // the diagonal is from a to d
};
Square squareAt(uvec2 low) {
  const uvec2 high = min(low + 1, (args.size_px - 1) / args.shrink);
  Square square = Square(low, pictureColor(low), vec3(0), vec3(0), vec3(0), false);
  if (args.shrink == 1) return square;
  square.b = pictureColor(uvec2(high.x, low.y));
  square.c = pictureColor(uvec2(low.x, high.y));
  square.d = pictureColor(high);
  square.falls =
      abs(brightnessOf(square.a) - brightnessOf(square.d)) < abs(brightnessOf(square.b) - brightnessOf(square.c));
  return square;
}

// Position in the picture, in its pixels from the centre of the first one.
vec2 placeOf(uvec2 pixel) {
  return clamp((vec2(pixel) + 0.5) / args.shrink - 0.5, vec2(0), vec2((args.size_px - 1) / args.shrink));
}

vec3 colorIn(Square square, uvec2 pixel) {
  if (args.shrink == 1) return square.a;
  const vec2 t = placeOf(pixel) - vec2(square.low);
  const vec3 a = square.a, b = square.b, c = square.c, d = square.d;
  if (square.falls) return t.x > t.y ? a + t.x * (b - a) + t.y * (d - b) : a + t.y * (c - a) + t.x * (d - c);
  return t.x + t.y < 1 ? a + t.x * (b - a) + t.y * (c - a) : d + (1 - t.x) * (c - d) + (1 - t.y) * (b - d);
}

void compose(uvec2 pixel, vec3 below) {
  const uint place = pixel.y * args.size_px.x + pixel.x;
  const uint blueAndThroughBits = args.layer.at[place].y;
  const uint redAndGreenBits = blueAndThroughBits == kPanelNothing ? 0 : args.layer.at[place].x;
  const vec2 blueAndThrough = unpackUnorm2x16(blueAndThroughBits);
  const vec3 color = vec3(unpackUnorm2x16(redAndGreenBits), blueAndThrough.x) + blueAndThrough.y * below;
  args.shown.at[place] = packUnorm4x8(vec4(args.blueFirst != 0 ? color.bgr : color, 1));
}

void main() {
  const uint square = threadIndex();
  if (square >= args.squares.x * args.squares.y) return;
  // The first squares reach beyond the border, where the picture has no further pixels to lie between.
  const ivec2 begin = ivec2(args.shrink * uvec2(square % args.squares.x, square / args.squares.x)) -
                      ivec2((args.shrink + 1) / 2 % args.shrink);
  const uvec2 first = uvec2(max(begin, ivec2(0))), end = min(uvec2(begin + int(args.shrink)), args.size_px);
  const bool hasPicture = uvec2(args.picture) != uvec2(0);
  Square between;
  if (hasPicture) between = squareAt(uvec2(placeOf(first)));
  for (uint y = first.y; y < end.y; ++y)
    for (uint x = first.x; x < end.x; ++x)
      compose(uvec2(x, y), hasPicture ? colorIn(between, uvec2(x, y)) : unpackUnorm4x8(args.background).rgb);
}
