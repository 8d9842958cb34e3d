// The light of all surfaces of a picture. It moves with the camera: a warm key light above on the left, a weak cool
// fill on the right, and a sky that is brighter than the ground (hemisphere light). Highlights after Blinn 1977
// (Blinn-Phong).
#ifndef PALPATE_RENDER_LIGHTING_GLSL
#define PALPATE_RENDER_LIGHTING_GLSL
#include "shaders/render/view.glsl"

// Directions towards the lights in eye space (depth grows away from the eye); intensities in linear light.
const vec3 kKeyDirection = vec3(-0.55, 0.66, -0.52);
const vec3 kKeyLight = vec3(0.95, 0.89, 0.80);
const vec3 kFillDirection = vec3(0.80, 0.05, -0.60);
const vec3 kFillLight = vec3(0.10, 0.125, 0.17);
const vec3 kSky = vec3(0.26, 0.29, 0.34);
const vec3 kGround = vec3(0.12, 0.10, 0.09);
const float kShininess = 36;  // exponent of the highlight
const float kGloss = 0.16;    // its strength

// Light that leaves a surface of colour `albedo` towards the eye. `normal` and `toViewer` are unit vectors in eye
// space; `access` is the share of the sky that reaches the surface.
vec3 lit(vec3 albedo, vec3 normal, vec3 toViewer, float access) {
  const vec3 key = normalize(kKeyDirection);
  const vec3 sky = mix(kGround, kSky, 0.5 + 0.5 * normal.y);
  const float keyCosine = max(dot(normal, key), 0);
  const vec3 diffuse = kKeyLight * keyCosine * mix(0.45, 1.0, access) +
                       kFillLight * max(dot(normal, normalize(kFillDirection)), 0) + sky * access;
  const float highlight = pow(max(dot(normal, normalize(key + toViewer)), 0), kShininess);
  return albedo * diffuse + kKeyLight * kGloss * highlight * access * min(4 * keyCosine, 1);
}

#endif
