// How a surface of each material sends the light of a picture (lighting.glsl) to the eye. Clay is the plain look.
#ifndef PALPATE_RENDER_MATERIALS_GLSL
#define PALPATE_RENDER_MATERIALS_GLSL
#include "shaders/render/lighting.glsl"
#include "shaders/shared/water.h"

const float kStoneRoughness = 0.6;  // standard deviation of the slopes of its facets, radians
const float kPlasterWrap = 0.4;     // how far light reaches around it
const float kMetalEnvironment = 2.1, kMetalHighlight = 1.6, kMetalDiffuse = 0.25, kMetalShininess = 60;
const vec3 kWaterBody = vec3(0.02, 0.20, 0.40);  // what deep water sends back
const float kWaterEnvironment = 2.4, kWaterHighlight = 0.9, kWaterShininess = 120;
const float kUnlitHollow = 0.35;  // light that is left in a hollow without any sky

// Arguments as for lit().
vec3 litStone(vec3 albedo, vec3 normal, vec3 toViewer, float access) {
  const vec3 key = normalize(kKeyDirection);
  const float squared = kStoneRoughness * kStoneRoughness;
  // Oren and Nayar 1994, the qualitative model.
  const float n = dot(normal, key), v = max(dot(normal, toViewer), 0), s = dot(key, toViewer) - n * v;
  const float flat_ = 1 - 0.5 * squared / (squared + 0.33), rim = 0.45 * squared / (squared + 0.09);
  const float cosine = max(n, 0) * (flat_ + rim * (s > 0 ? s / max(max(n, v), 1e-3) : s));
  const vec3 fill = kFillLight * max(dot(normal, normalize(kFillDirection)), 0);
  return albedo *
         (kKeyLight * cosine * mix(0.45, 1.0, access) + fill + mix(kGround, kSky, 0.5 + 0.5 * normal.y) * access);
}
// Light that is scattered below the surface reaches behind the edge of the shadow (wrapped diffuse light).
vec3 litPlaster(vec3 albedo, vec3 normal, float access) {
  const float wrapped = max((dot(normal, normalize(kKeyDirection)) + kPlasterWrap) / (1 + kPlasterWrap), 0);
  const vec3 fill = kFillLight * max(dot(normal, normalize(kFillDirection)), 0);
  return albedo * (0.85 * kKeyLight * wrapped * mix(0.55, 1.0, access) + fill +
                   mix(kGround, kSky, 0.5 + 0.5 * normal.y) * access);
}
// Reflects the sky, the ground and the key light, each in its own colour; more and whiter towards the rim (Schlick
// 1994).
vec3 litMetal(vec3 albedo, vec3 normal, vec3 toViewer, float access) {
  const vec3 key = normalize(kKeyDirection);
  const vec3 mirrored = reflect(-toViewer, normal);
  const vec3 color = albedo + (1 - albedo) * pow(1 - clamp(dot(normal, toViewer), 0, 1), 5);
  const vec3 around = mix(kGround, kSky, smoothstep(-0.5, 0.8, mirrored.y));
  const float highlight = pow(max(dot(normal, normalize(key + toViewer)), 0), kMetalShininess);
  return color * (kMetalEnvironment * around * access + kMetalHighlight * kKeyLight * highlight * access +
                  kMetalDiffuse * kKeyLight * max(dot(normal, key), 0));
}

// Share of the light that water reflects (Schlick 1994).
float waterReflectance(vec3 normal, vec3 toViewer) {
  return kWaterReflectance + (1 - kWaterReflectance) * pow(1 - clamp(dot(normal, toViewer), 0, 1), 5);
}
// `body`: the colour of what is in the water, which the sky and the key light shine on; `gloss`: strength of the
// highlight.
vec3 litWater(vec3 body, vec3 normal, vec3 toViewer, float gloss) {
  const vec3 key = normalize(kKeyDirection);
  const vec3 mirrored = reflect(-toViewer, normal);
  const vec3 around = kWaterEnvironment * mix(kGround, kSky, smoothstep(-0.4, 0.6, mirrored.y));
  const vec3 inside = body * (mix(kGround, kSky, 0.5 + 0.5 * normal.y) + 0.6 * kKeyLight * max(dot(normal, key), 0));
  const float highlight = pow(max(dot(normal, normalize(key + toViewer)), 0), kWaterShininess);
  const float reflectance = waterReflectance(normal, toViewer);
  return mix(inside, around, reflectance) + gloss * kWaterHighlight * kKeyLight * highlight;
}

// What stands in water is clay.
vec3 litAs(uint material, vec3 albedo, vec3 normal, vec3 toViewer, float access) {
  switch (material) {
    case kMaterialStone:
      return litStone(albedo, normal, toViewer, access);
    case kMaterialPlaster:
      return litPlaster(albedo, normal, access);
    case kMaterialMetal:
      return litMetal(albedo, normal, toViewer, access);
    case kMaterialUnlit:
      return albedo * mix(kUnlitHollow, 1.0, access);
  }
  return lit(albedo, normal, toViewer, access);
}

#endif
