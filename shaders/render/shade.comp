#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference_uvec2 : require
// Turns the sums of every sample into light with its opacity, or into the requested intermediate image.
#include "shaders/lib/index.glsl"
#include "shaders/render/color.glsl"
#include "shaders/render/depth_slope.glsl"
#include "shaders/render/frame_block.glsl"
#include "shaders/render/materials.glsl"
#include "shaders/render/occlusion.glsl"
#include "shaders/render/sums.glsl"
#include "shaders/render/surfel.glsl"
#include "shaders/shared/look.h"
#include "shaders/shared/ramp.h"

// Not 0: with materials, and with what Relief has made. The plain look is a variant of its own, so that it costs no
// more.
layout(constant_id = 1) const uint kRelief = 0;

layout(push_constant, scalar) uniform Push { ShadeArgs args; };

// The surface's own colour, linear light. `place` is the sample whose sums count.
vec3 albedoAt(uint place, vec3 normal, vec3 position, float depth) {
  const uint colorBy = frame.colorBy;
  const vec3 low = frame.boundsMin, high = frame.boundsMax;
  const float near = frame.depthMin, far = frame.depthMax;
  if (colorBy == kColorByNormal) return toLinear(0.5 + 0.5 * normal);
  const uint map = frame.colorMap;
  if (colorBy == kColorByDepth) return toLinear(rampColor(map, (far - depth) / max(far - near, 1e-30)));
  if (colorBy == kColorByHeight) {
    const vec3 up = frame.up;
    const float bottom = min(dot(low, up), dot(high, up)), top = max(dot(low, up), dot(high, up));
    return toLinear(rampColor(map, (dot(position, up) - bottom) / max(top - bottom, 1e-30)));
  }
  if (frame.hasColors == 0) return frame.baseColor;
  const uvec2 size = frame.view.size_px;
  return toLinear(colorAt(args.colorSums, place, size.x * size.y) / max(weightAt(args.normalSums, place), 1));
}

// Light of a sample at `place_px` whose surface is that of the sample `place`.
vec3 surfaceAt(RenderView view, uint place, vec2 place_px, float depth) {
  const uint imagePass = frame.imagePass;
  const vec3 inEye = pointAt(view, place_px, depth);
  const vec3 sight = sightTo(view, inEye);
  const vec3 position = view.eye + fromEye(view, inEye);
  const ivec2 pixel = ivec2(place % view.size_px.x, place / view.size_px.x);
  vec3 normal = frame.smooth_px == 0 ? normalAt(args.normalSums, place)
                                                : fromEye(view, normalFromDepth(view, args.depth, pixel));
  const vec3 away = view.isOrthographic != 0 ? view.forward : position - view.eye;
  normal = dot(normal, normal) > 0 ? normalize(normal) : -normalize(away);

  const vec3 low = frame.boundsMin, high = frame.boundsMax;
  const float near = frame.depthMin, far = frame.depthMax;
  if (imagePass == kPassDepth || imagePass == kPassSmoothDepth)
    return toLinear(vec3(mix(0.15, 1, clamp((far - depth) / max(far - near, 1e-30), 0, 1))));
  if (imagePass == kPassNormal) return toLinear(0.5 + 0.5 * normal);
  if (imagePass == kPassPosition) return toLinear(clamp((position - low) / max(high - low, vec3(1e-30)), 0, 1));
  const vec3 albedo = albedoAt(place, normal, position, depth);
  if (imagePass == kPassColor) return albedo;
  const bvec2 has =
      bvec2(kRelief != 0 && uvec2(args.access) != uvec2(0), kRelief != 0 && uvec2(args.cavity) != uvec2(0));
  vec2 relief = vec2(1);
  if (any(has)) relief = atSample(view, args.access, args.cavity, has, args.surfels, uvec2(place_px), depth);
  const float access = has.x ? pow(relief.x, kOcclusionPower)
                             : opennessAt(view, args.depth, place_px, inEye, toEye(view, normal),
                                          frame.occlusionRadius, frame.usualRadius);
  if (kRelief == 0) return lit(albedo, toEye(view, normal), -normalize(sight), access);
  return relief.y * litAs(frame.material, albedo, toEye(view, normal), -normalize(sight), access);
}

void main() {
  const RenderView view = frame.view;
  const uint place = threadIndex();
  if (place >= view.size_px.x * view.size_px.y) return;
  const vec2 place_px = vec2(place % view.size_px.x, place / view.size_px.x) + 0.5;
  const uint source = args.source.at[place];
  const uint bits = args.depth.at[source];
  const vec4 light = bits == kNoDepth ? vec4(mix(frame.backgroundTop, frame.backgroundBottom,
                                                 place_px.y / float(view.size_px.y)),
                                             frame.backgroundOpacity)
                                      : vec4(surfaceAt(view, source, place_px, uintBitsToFloat(bits)), 1);
  args.shaded.at[place] = uvec2(packHalf2x16(light.rg), packHalf2x16(light.ba));
}
