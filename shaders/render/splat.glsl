// A point as an oriented disc, and the square of pixels that one invocation walks for it. Both splat passes see exactly
// the same fragments through this file.
#ifndef PALPATE_RENDER_SPLAT_GLSL
#define PALPATE_RENDER_SPLAT_GLSL
#include "shaders/lib/frame.glsl"
#include "shaders/lib/index.glsl"
#include "shaders/render/view.glsl"

layout(push_constant, scalar) uniform Push { SplatArgs args; };

const float kOutlineFacing = 0.7;  // cosine; more calls insides outlines, less lights outlines as insides
const float kEdgeTrust = 0.1;      // of a disc on edge; more roughens outlines and folds
// Of a disc seen from its back: it counts where no other does. More lets the far side of an edge shine through.
const float kBackTrust = 1.0 / 256;

struct Splat {
  uint point;
  vec3 center;    // eye space
  vec3 normal;    // of the disc, eye space, unit, either side
  float radius;   // model units
  vec3 clip;      // eye space: the disc ends where the dot product of this and the offset from its centre exceeds 1
  vec3 shading;   // normal to light it by, model space, unit, never away from the eye
  float trust;    // in the shading normal, against other splats' in the same sample
  ivec2 centerPixel;
  ivec2 first, last;  // pixels to walk, both included; none when first exceeds last
};

// What [low, high] at depths from `shallow` to `deep` can cover in the picture, in units of the focal length.
vec2 projectedInterval(float low, float high, float shallow, float deep) {
  return vec2(low / (low < 0 ? shallow : deep), high / (high < 0 ? deep : shallow));
}

// The line along which a disc is cut off (shaders/shared/splat_radius.h), from radii in its own plane.
vec3 clipOf(RenderView view, uint point, vec4 normalAndRadius) {
  const uint bits = args.clips.at[point];
  if (bits == 0) return vec3(0);
  vec3 u, v;
  frameAround(normalAndRadius.xyz, u, v);
  const vec2 clip = unpackHalf2x16(bits) / normalAndRadius.w;
  return toEye(view, clip.x * u + clip.y * v);
}

// Which way a disc lies and how it is lit. A disc without a normal faces the eye. One that is seen from its back a
// little stands just behind an outline and peeps over it: it is lit as if it were the outline. Seen from the back in
// full it is the inside of an open surface, and its normal is turned. Discs on edge stand out from the surface where a
// scan has a fold or a stray normal, so the flatter a disc lies before the eye, the more it counts.
void orient(RenderView view, inout Splat splat) {
  const float everyones = args.frame.at[0].splatRadius;
  const vec3 toViewer = -normalize(splat.center);
  const vec4 normalAndRadius = args.normals.at[splat.point];
  splat.normal = toEye(view, normalAndRadius.xyz);
  if (!(dot(splat.normal, splat.normal) >= 0.25)) splat.normal = toViewer;
  splat.radius = everyones > 0 ? everyones : normalAndRadius.w;
  splat.clip = everyones > 0 ? vec3(0) : clipOf(view, splat.point, normalAndRadius);
  const float facing = dot(splat.normal, toViewer);
  vec3 shading = splat.normal;
  if (facing < -kOutlineFacing) shading = -shading;
  else if (facing < 0) shading = normalize(shading - facing * toViewer);
  splat.shading = fromEye(view, shading);
  splat.trust = facing > 0 ? max(facing, kEdgeTrust) : kBackTrust;
}

// This invocation's share of a splat; false when it has none. `view` is frame.view, held in registers by the caller.
bool loadSplat(RenderView view, out Splat splat) {
  const uint tiles = args.frame.at[0].splatTiles;
  const uint thread = threadIndex();
  splat.point = thread / (tiles * tiles);
  if (splat.point >= args.frame.at[0].count) return false;
  splat.center = toEye(view, args.positions.at[splat.point].xyz - view.eye);
  const vec3 c = splat.center;
  if (!(c.z >= view.nearDepth)) return false;
  const vec2 center_px = sampleOf(view, c);
  if (!all(lessThan(abs(center_px - view.center_px), vec2(1e6)))) return false;  // must fit an int with its disc

  orient(view, splat);

  // The box around a disc reaches R sqrt(1 - n_k^2) along axis k.
  const vec3 reach = splat.radius * sqrt(max(1 - splat.normal * splat.normal, 0));
  const float shallow = max(c.z - reach.z, view.nearDepth);
  const float deep = c.z + reach.z;
  const vec2 x = view.center_px.x + view.focal_px * projectedInterval(c.x - reach.x, c.x + reach.x, shallow, deep);
  const vec2 y = view.center_px.y + view.focal_px * projectedInterval(-c.y - reach.y, -c.y + reach.y, shallow, deep);
  splat.centerPixel = ivec2(floor(center_px));
  const int side = int(tiles * kSplatTile);
  const ivec2 corner = splat.centerPixel - side / 2;  // of the square that all shares together can walk
  splat.first = max(ivec2(floor(clamp(vec2(x.x, y.x), -2e6, 2e6))), corner);
  splat.last = min(ivec2(floor(clamp(vec2(x.y, y.y), -2e6, 2e6))), corner + side - 1);
  splat.first = max(min(splat.first, splat.centerPixel), ivec2(0));
  splat.last = min(max(splat.last, splat.centerPixel), ivec2(view.size_px) - 1);

  // Shares start at the first visible pixel, so that a splat of one tile has one share wherever it lies.
  const uint share = thread % (tiles * tiles);
  splat.first += ivec2(share % tiles, share / tiles) * int(kSplatTile);
  splat.last = min(splat.last, splat.first + int(kSplatTile) - 1);
  return all(lessThanEqual(splat.first, splat.last));
}

struct Fragment {
  float depth;   // eye space, on the disc's plane
  float weight;  // the disc's trust in its middle, kRimWeight of that at its rim
};

// False where the ray through the pixel misses the disc. Edge-on discs are safe: a hit lies within the disc, so its
// depth is within a radius of the centre's, and a ray along the plane gives no number and no hit. The pixel that holds
// the centre is always covered, so that splats smaller than a pixel leave no holes.
bool coverPixel(RenderView view, Splat splat, float inverseRadiusSquared, ivec2 pixel, out Fragment fragment) {
  const vec3 ray = rayThrough(view, vec2(pixel) + 0.5);
  fragment.depth = dot(splat.normal, splat.center) / dot(splat.normal, ray);
  const vec3 offset = fragment.depth * ray - splat.center;
  const float q = dot(offset, offset) * inverseRadiusSquared;
  if (q < 1 && fragment.depth >= view.nearDepth && dot(offset, splat.clip) <= 1) {
    fragment.weight = splat.trust * max((1 - q) * (1 - q), kRimWeight);
    return true;
  }
  fragment.depth = splat.center.z;
  fragment.weight = splat.trust * kCenterPixelWeight;
  return pixel == splat.centerPixel;
}

#endif
