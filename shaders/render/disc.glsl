// A point as an oriented disc, and its fragment in each pixel: the same for all renderers.
#ifndef PALPATE_RENDER_DISC_GLSL
#define PALPATE_RENDER_DISC_GLSL
#include "shaders/render/frame_block.glsl"
#include "shaders/render/view.glsl"
#include "shaders/shared/frame.h"

// Cosines between which the back of a disc becomes the inside of an open surface: more treats insides as outlines,
// which are dark, less lights outlines as insides.
const float kOutlineFacing = 0.2, kInsideFacing = 0.45;
const float kEdgeTrust = 0.1;      // of a disc seen edge-on; more roughens outlines and folds
// Of a disc seen from its back: it counts only if no other disc does. More lets the far side of an edge shine through.
const float kBackTrust = 1.0 / 256;

struct Disc {
  vec3 center;   // eye space
  vec3 normal;   // eye space, unit, either side
  float radius;  // model units
  vec3 clip;     // eye space: the disc ends where the dot product of this and the offset from its centre exceeds 1
  vec3 shading;  // normal to light it by, model space, unit, never away from the eye
  float trust;   // in the shading normal, against other discs' in the same sample
  ivec2 centerPixel;
};

// Interval of the picture that [low, high] can cover, with divisors from `shallow` to `deep`, in focal lengths.
vec2 projectedInterval(float low, float high, float shallow, float deep) {
  return vec2(low / (low < 0 ? shallow : deep), high / (high < 0 ? deep : shallow));
}

// The line along which a disc is clipped (shaders/shared/splat_radius.h), from radii in its own plane.
vec3 clipOf(RenderView view, vec4 normalAndRadius, uint bits) {
  if (bits == 0) return vec3(0);
  vec3 u, v;
  frameAround(normalAndRadius.xyz, u, v);
  const vec2 clip = unpackHalf2x16(bits) / normalAndRadius.w;
  return toEye(view, clip.x * u + clip.y * v);
}

// Position of a disc's middle in the picture; false if it is not visible.
bool placeDisc(RenderView view, vec3 position, out Disc disc) {
  disc.center = toEye(view, position - view.eye);
  if (!(disc.center.z >= view.nearDepth)) return false;
  const vec2 center_px = sampleOf(view, disc.center);
  if (!all(lessThan(abs(center_px - view.center_px), vec2(1e6)))) return false;  // must fit an int with its disc
  disc.centerPixel = ivec2(floor(center_px));
  return true;
}

// Orientation and shading normal of a disc; without a normal it faces the eye. False if it is not visible, as its back
// is if `hidesBacks` is not 0. A disc seen slightly from its back
// sticks out over an outline, and is lit as the outline. Seen more from the back it is the inside of an open surface,
// and its normal is reversed. Discs seen edge-on stand out of the surface at folds and outlying normals, so they count
// less. `commonRadius`: the radius of all discs, which are then not clipped; 0: each has its own.
bool orientDisc(RenderView view, vec4 normalAndRadius, uint clipBits, float commonRadius, uint hidesBacks,
                inout Disc disc) {
  const vec3 toViewer = -normalize(sightTo(view, disc.center));
  disc.normal = toEye(view, normalAndRadius.xyz);
  if (!(dot(disc.normal, disc.normal) >= 0.25)) disc.normal = toViewer;
  disc.radius = commonRadius > 0 ? commonRadius : normalAndRadius.w;
  disc.clip = commonRadius > 0 ? vec3(0) : clipOf(view, normalAndRadius, clipBits);
  const float facing = dot(disc.normal, toViewer);
  if (hidesBacks != 0 && facing < 0) return false;
  vec3 shading = disc.normal;
  if (facing < 0) {
    const vec3 outline = (shading - facing * toViewer) * inversesqrt(max(1 - facing * facing, 1e-6));
    shading = normalize(mix(outline, -shading, smoothstep(kOutlineFacing, kInsideFacing, -facing)));
  }
  disc.shading = fromEye(view, shading);
  disc.trust = facing > 0 ? max(facing, kEdgeTrust) : kBackTrust;
  return true;
}

struct PixelBox {
  ivec2 first, last;  // both included; empty if first exceeds last
};

// The pixels of the picture that a disc may cover. The box around a disc reaches R sqrt(1 - n_k^2) along axis k.
PixelBox boxOf(RenderView view, Disc disc) {
  const vec3 c = disc.center;
  const vec3 reach = disc.radius * sqrt(max(1 - disc.normal * disc.normal, 0));
  const float shallow = divisorAt(view, max(c.z - reach.z, view.nearDepth));
  const float deep = divisorAt(view, c.z + reach.z);
  const vec2 x = view.center_px.x + view.focal_px * projectedInterval(c.x - reach.x, c.x + reach.x, shallow, deep);
  const vec2 y = view.center_px.y + view.focal_px * projectedInterval(-c.y - reach.y, -c.y + reach.y, shallow, deep);
  const ivec2 first = ivec2(floor(clamp(vec2(x.x, y.x), -2e6, 2e6)));
  const ivec2 last = ivec2(floor(clamp(vec2(x.y, y.y), -2e6, 2e6)));
  return PixelBox(max(min(first, disc.centerPixel), ivec2(0)),
                  min(max(last, disc.centerPixel), ivec2(view.size_px) - 1));
}

struct Fragment {
  float depth;   // eye space, in the disc's plane
  float weight;  // the disc's trust in its middle, kRimWeight times that at its rim
};

// False if the ray through the pixel misses the disc. Edge-on discs are safe: a hit is within the disc, so its depth is
// within a radius of the centre's, and a ray along the plane gives a NaN and no hit. The pixel that contains the centre
// is always covered, so that discs smaller than a pixel do not leave holes.
bool coverPixel(RenderView view, Disc disc, float inverseRadiusSquared, ivec2 pixel, out Fragment fragment) {
  const vec3 ray = rayThrough(view, vec2(pixel) + 0.5);
  const vec3 center = disc.center - rayFrom(view, vec2(pixel) + 0.5);
  fragment.depth = dot(disc.normal, center) / dot(disc.normal, ray);
  const vec3 offset = fragment.depth * ray - center;
  const float q = dot(offset, offset) * inverseRadiusSquared;
  if (q < 1 && fragment.depth >= view.nearDepth && dot(offset, disc.clip) <= 1) {
    fragment.weight = disc.trust * max((1 - q) * (1 - q), kRimWeight);
    return true;
  }
  fragment.depth = disc.center.z;
  fragment.weight = disc.trust * kCenterPixelWeight;
  return pixel == disc.centerPixel;
}

#endif
