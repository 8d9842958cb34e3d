// The share of the sky that is visible from a sample past the surface around it, from the depth image alone: the
// estimator of McGuire, Mara and Luebke 2012 (Scalable ambient obscurance, section 2), with its taps on a spiral that
// is rotated from sample to sample.
#ifndef PALPATE_RENDER_OCCLUSION_GLSL
#define PALPATE_RENDER_OCCLUSION_GLSL
#include "shaders/render/view.glsl"

const uint kTaps = 14;
const float kTurns = 5;               // of the spiral; with kTaps no two taps lie on one ray
const float kStep = 6.2831853 * kTurns / float(kTaps);  // of the spiral's angle, from tap to tap
const float kOcclusionStrength = 2.4;
const float kWidest_px = 160;         // of the spiral, samples; at close range, wider ones only cost time

// A number from 0 to 1 that differs strongly between neighbours (Jimenez 2014, interleaved gradient noise).
float turnOf(vec2 place_px) { return fract(52.9829189 * fract(dot(place_px, vec2(0.06711056, 0.00583715)))); }

// 1: open, 0: enclosed. `position` and `normal` in eye space; `bias`: how far discs stand out of the true surface.
float opennessAt(RenderView view, Uints depths, vec2 place_px, vec3 position, vec3 normal, float radius, float bias) {
  const float radius_px = min(radius * view.focal_px / divisorAt(view, position.z), kWidest_px);
  if (radius_px < 1) return 1;
  // From tap to tap by a constant rotation: sines of each would take most of the time.
  const float angle = kStep * 0.5 + 6.2831853 * turnOf(floor(place_px));
  const mat2 rotation = mat2(cos(kStep), sin(kStep), -sin(kStep), cos(kStep));
  vec2 along = vec2(cos(angle), sin(angle));
  float sum = 0;
  for (uint k = 0; k < kTaps; ++k, along = rotation * along) {
    const float share = (float(k) + 0.5) / float(kTaps);
    const vec2 at_px = place_px + radius_px * share * along;
    if (any(lessThan(at_px, vec2(0))) || any(greaterThanEqual(at_px, vec2(view.size_px)))) continue;
    const uint bits = depths.at[uint(at_px.y) * view.size_px.x + uint(at_px.x)];
    if (bits == kNoDepth) continue;
    const vec2 there_px = floor(at_px) + 0.5;
    const vec3 away = uintBitsToFloat(bits) * rayThrough(view, there_px) - (position - rayFrom(view, there_px));
    const float squared = dot(away, away), rest = max(radius * radius - squared, 0) / (radius * radius);
    sum += rest * rest * rest * max(dot(away, normal) - bias, 0) / sqrt(squared + bias * bias);
  }
  return clamp(1 - kOcclusionStrength * 2 * sum / float(kTaps), 0, 1);
}

#endif
