#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference_uvec2 : require
// The picture: blends the overlays over every sample, averages the samples of a pixel in linear light and encodes the
// result. Opacity is kept beside the colour, which is not multiplied by it. A variant without overlays processes all
// pixels, and one with overlays repeats the pixels that they may cover: overlays get at least four samples per pixel
// even if the surface has one.
#include "shaders/lib/index.glsl"
#include "shaders/render/frame_block.glsl"
#include "shaders/render/overlays.glsl"

layout(constant_id = 1) const uint kLaysOver = 0;

layout(push_constant, scalar) uniform Push { ResolveArgs args; };

// Less than half a step of eight bits either way (Bayer 1973): avoids banding in dark gradients, and keeps colours that
// eight bits represent exactly.
float ditherAt(uvec2 pixel) {
  const uint x = pixel.x ^ pixel.y, y = pixel.y;
  const uint rank = (x & 1) << 3 | (y & 1) << 2 | (x & 2) | (y & 2) >> 1;
  return 0.9 / 255 * ((float(rank) + 0.5) / 16 - 0.5);
}

void main() {
  const RenderView view = frame.view;
  const uvec2 size = view.size_px / view.supersample;
  const uint thread = threadIndex();
  if (thread >= args.size_px.x * args.size_px.y) return;
  const uvec2 pixel = args.first_px + uvec2(thread % args.size_px.x, thread / args.size_px.x);
  const uint place = pixel.y * size.x + pixel.x;
  const bool overlays = kLaysOver != 0, isOwn = uvec2(args.source) == uvec2(0);
  const uint split = overlays ? max(view.supersample, 2) : view.supersample;  // samples along each side of a pixel

  vec4 sum = vec4(0);  // light times opacity, and opacity
  uint nearest = kNoDepth;
  for (uint k = 0; k < split * split; ++k) {
    const vec2 place_px = (vec2(pixel) + (vec2(k % split, k / split) + 0.5) / float(split)) * float(view.supersample);
    const uint at = uint(place_px.y) * view.size_px.x + uint(place_px.x);
    const uvec2 packed = args.shaded.at[at];
    const uint depth = args.depth.at[isOwn ? at : args.source.at[at]];
    vec4 light = vec4(unpackHalf2x16(packed.x), unpackHalf2x16(packed.y));
    if (overlays)
      light = overlaid(view, frame.overlays, place_px, uintBitsToFloat(depth), light);
    sum += clamp(light, 0, 1);
    nearest = min(nearest, depth);
  }
  const float dither = frame.imagePass == kPassFinal ? ditherAt(pixel) : 0;
  const vec3 color = sum.a > 0 ? toEncoded(sum.rgb / sum.a) + dither : vec3(0);
  args.image.at[place] = packUnorm4x8(vec4(color, sum.a / float(split * split)));
  args.depthImage.at[place] = nearest == kNoDepth ? 0 : uintBitsToFloat(nearest);
}
