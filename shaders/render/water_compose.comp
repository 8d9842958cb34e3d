#version 460
#extension GL_GOOGLE_include_directive : require
// Water, pass 5: the light of every sample. Behind the surface is what is not water, shifted by the slope of the
// surface and absorbed over the thickness; the surface reflects the sky.
#include "shaders/render/depth_slope.glsl"
#include "shaders/render/frame_block.glsl"
#include "shaders/render/materials.glsl"
#include "shaders/render/water.glsl"

// As normalFromDepth(), of the smoothed depths.
float surfaceDepth(ivec2 size, ivec2 at) {
  if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, size))) return uintBitsToFloat(kNoDepth);
  return uintBitsToFloat(args.across.at[uint(at.y * size.x + at.x)].x);
}
vec3 normalOf(RenderView view, ivec2 at, float depth) {
  const ivec2 size = ivec2(view.size_px);
  const float right = gentlerStep(surfaceDepth(size, at - ivec2(1, 0)), depth, surfaceDepth(size, at + ivec2(1, 0)));
  const float down = gentlerStep(surfaceDepth(size, at - ivec2(0, 1)), depth, surfaceDepth(size, at + ivec2(0, 1)));
  return normalOfSlope(view, at, depth, vec2(right, down));
}

vec4 lightAt(uint place) {
  const uvec2 packed = args.behind.at[place];
  return vec4(unpackHalf2x16(packed.x), unpackHalf2x16(packed.y));
}
float depthBehind(uint place) { return uintBitsToFloat(args.depth.at[args.source.at[place]]); }

void main() {
  const RenderView samples = frame.view;
  const RenderView view = pictureView(samples);
  const uint place = threadIndex();
  if (place >= samples.size_px.x * samples.size_px.y) return;
  const ivec2 at = ivec2(place % samples.size_px.x, place / samples.size_px.x);
  const ivec2 pixel = at / int(samples.supersample);
  const uvec2 bits = args.across.at[uint(pixel.y) * view.size_px.x + uint(pixel.x)];
  const float depth = uintBitsToFloat(bits.x);
  const vec2 amount = unpackHalf2x16(bits.y);
  // The cover of a straight rim falls by this in one pixel.
  const float fall = 2.5066 * 0.5 * kWaterSmooth * ballAt(view, depth);
  const float cover = clamp(0.5 + (amount.y - 0.5) * fall, 0, 1);
  const float end = depthBehind(place);
  // Smoothing does not spread water over what stands before it.
  const bool isSpread = args.fronts.at[uint(pixel.y) * view.size_px.x + uint(pixel.x)] == kNoDepth && !isinf(end);
  if (!(depth < end) || cover <= 0 || isSpread) {
    args.shaded.at[place] = args.behind.at[place];
    args.surface.at[place] = floatBitsToUint(end);
    return;
  }
  const vec3 normal = normalOf(view, pixel, depth);
  const vec3 toViewer = -normalize(sightTo(view, pointAt(view, vec2(pixel) + 0.5, depth)));
  const float thickness = amount.x * args.side;
  const vec2 shift_px = clamp(-kWaterBend * thickness * samples.focal_px / divisorAt(view, depth) *
                                  vec2(normal.x, -normal.y),
                              -kMaxWaterBend_px * float(samples.supersample),
                              kMaxWaterBend_px * float(samples.supersample));
  const ivec2 there = clamp(at + ivec2(round(shift_px)), ivec2(0), ivec2(samples.size_px) - 1);
  const uint shifted = uint(there.y) * samples.size_px.x + uint(there.x);
  const vec4 behind = lightAt(depthBehind(shifted) > depth ? shifted : place), beside = lightAt(place);
  const vec3 passes = exp(-kWaterAbsorption * amount.x);
  const float reflectance = waterReflectance(normal, toViewer);
  // At the rim depths are those of pixels beside it, and would glitter.
  const float gloss = clamp(2 * amount.y - 1, 0, 1);
  const vec3 own = litWater((1 - passes) * kWaterBody, normal, toViewer, gloss);
  // Light times opacity; what is behind the picture shines through as far as it does in green.
  const vec3 inWater = own + (1 - reflectance) * passes * behind.rgb * behind.a;
  const float opacity = 1 - (1 - behind.a) * (1 - reflectance) * passes.g;
  const vec3 light = mix(beside.rgb * beside.a, inWater, cover);
  const float opaque = mix(beside.a, opacity, cover);
  const vec3 result = opaque > 0 ? light / opaque : vec3(0);
  args.shaded.at[place] = uvec2(packHalf2x16(result.rg), packHalf2x16(vec2(result.b, opaque)));
  args.surface.at[place] = floatBitsToUint(cover >= 0.5 ? depth : end);
}
