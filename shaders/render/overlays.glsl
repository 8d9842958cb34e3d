// The ball at the HIP, the disc at the proxy, the force arrow, the outline of the tool and the scale bar, each a closed
// form along a ray. Rays start at depth 0 with depth 1 per unit, so a ray's parameter is the depth.
#ifndef PALPATE_RENDER_OVERLAYS_GLSL
#define PALPATE_RENDER_OVERLAYS_GLSL
#include "shaders/render/color.glsl"
#include "shaders/render/lighting.glsl"

const vec3 kBallColor = vec3(1.00, 0.44, 0.02);   // sRGB
const vec3 kDiscColor = vec3(0.10, 0.78, 0.92);
const vec3 kArrowColor = vec3(0.92, 0.10, 0.36);
const vec3 kBrushColor = vec3(0.98, 0.90, 0.30);
const float kOutlineWidth = 0.03;  // of the tool's radius, and
const float kThinnest_px = 3;      // samples at least
const float kBarEnd = 3.0;          // radius of the discs at the bar's ends, in radii of the bar
const float kHiddenAlpha = 0.4;  // of an overlay behind the surface
const float kHeadWidth = 2.4;    // of the arrow, in radii of the shaft
const float kHeadLength = 6.0;   // in radii of the shaft; at most half the arrow

struct Hit {
  float depth;  // kMiss: no hit
  vec3 normal;  // model space, unit, outward
};
const float kMiss = 3.0e38;

Hit nearer(Hit a, Hit b) { return a.depth <= b.depth ? a : b; }

Hit hitBall(vec3 eye, vec3 ray, vec3 center, float radius) {
  const vec3 toCenter = center - eye;
  const float along = dot(ray, toCenter) / dot(ray, ray);
  const vec3 offset = along * ray - toCenter;  // from the centre to the ray; small, so nothing cancels
  const float rest = (radius * radius - dot(offset, offset)) / dot(ray, ray);
  if (!(rest >= 0)) return Hit(kMiss, vec3(0));
  const float depth = along - sqrt(rest);
  return Hit(depth > 0 ? depth : kMiss, (depth * ray - toCenter) / radius);
}

// A disc of no thickness across `axis`.
Hit hitDisc(vec3 eye, vec3 ray, vec3 center, vec3 axis, float radius) {
  const float depth = dot(axis, center - eye) / dot(axis, ray);
  const vec3 offset = eye + depth * ray - center;
  const bool inside = depth > 0 && dot(offset, offset) <= radius * radius;
  return Hit(inside ? depth : kMiss, dot(axis, ray) < 0 ? axis : -axis);
}

// The side of a cone frustum that runs from radius r0 at `base` to r1 at base + length * axis; r0 = r1: a cylinder.
Hit hitFrustum(vec3 eye, vec3 ray, vec3 base, vec3 axis, float length, float r0, float r1) {
  const float slope = (r1 - r0) / length;
  // Start at the ray's closest approach to the base: squares of large distances would cancel.
  const float start = dot(base - eye, ray) / dot(ray, ray);
  const vec3 from = eye + start * ray - base;
  const float h0 = dot(from, axis), dh = dot(ray, axis);
  const vec3 p = from - h0 * axis, d = ray - dh * axis;
  const float radius0 = r0 + slope * h0, dr = slope * dh;
  const float a = dot(d, d) - dr * dr, b = dot(p, d) - radius0 * dr, c = dot(p, p) - radius0 * radius0;
  const float discriminant = b * b - a * c;
  if (!(discriminant >= 0) || a == 0) return Hit(kMiss, vec3(0));
  const float root = sqrt(discriminant) * sign(a);
  for (uint k = 0; k < 2; ++k) {
    const float t = (-b + (k == 0 ? -root : root)) / a;
    const float h = h0 + t * dh;
    if (start + t <= 0 || h < 0 || h > length || r0 + slope * h < 0) continue;
    return Hit(start + t, normalize(normalize(p + t * d) - slope * axis));
  }
  return Hit(kMiss, vec3(0));
}

Hit hitThickDisc(vec3 eye, vec3 ray, RenderOverlays o) {
  const vec3 top = o.discCenter + o.discHalfThickness * o.discNormal;
  const vec3 bottom = o.discCenter - o.discHalfThickness * o.discNormal;
  Hit hit = hitFrustum(eye, ray, bottom, o.discNormal, 2 * o.discHalfThickness, o.discRadius, o.discRadius);
  hit = nearer(hit, hitDisc(eye, ray, top, o.discNormal, o.discRadius));
  return nearer(hit, hitDisc(eye, ray, bottom, o.discNormal, o.discRadius));
}

Hit hitArrow(vec3 eye, vec3 ray, RenderOverlays o) {
  const float head = min(kHeadLength * o.arrowRadius, 0.5 * o.arrowLength);
  const float shaft = o.arrowLength - head;
  const vec3 neck = o.arrowFrom + shaft * o.arrowDirection;
  const float headRadius = kHeadWidth * o.arrowRadius;
  Hit hit = hitFrustum(eye, ray, o.arrowFrom, o.arrowDirection, shaft, o.arrowRadius, o.arrowRadius);
  hit = nearer(hit, hitFrustum(eye, ray, neck, o.arrowDirection, head, headRadius, 0));
  hit = nearer(hit, hitDisc(eye, ray, neck, o.arrowDirection, headRadius));
  return nearer(hit, hitDisc(eye, ray, o.arrowFrom, o.arrowDirection, o.arrowRadius));
}

// A ball's outline: the rays near its rim, at the depth where they are closest to its middle.
Hit hitOutline(RenderView view, vec3 eye, vec3 ray, vec3 center, float radius) {
  const vec3 toCenter = center - eye;
  const float along = dot(ray, toCenter) / dot(ray, ray);
  const float off = length(along * ray - toCenter);
  const float width = max(kOutlineWidth * radius, kThinnest_px * divisorAt(view, along) / view.focal_px);
  const bool onRim = along > 0 && off <= radius && off >= radius - width;
  return Hit(onRim ? along : kMiss, -normalize(ray));
}

Hit hitBar(vec3 eye, vec3 ray, RenderOverlays o) {
  const vec3 to = o.barFrom + o.barLength * o.barDirection;
  const float thickness = o.barRadius;  // of the discs
  const vec3 last = to - thickness * o.barDirection;
  const float end = kBarEnd * o.barRadius;
  Hit hit = hitFrustum(eye, ray, o.barFrom, o.barDirection, o.barLength, o.barRadius, o.barRadius);
  hit = nearer(hit, hitFrustum(eye, ray, o.barFrom, o.barDirection, thickness, end, end));
  hit = nearer(hit, hitFrustum(eye, ray, last, o.barDirection, thickness, end, end));
  hit = nearer(hit, hitDisc(eye, ray, o.barFrom, o.barDirection, end));
  return nearer(hit, hitDisc(eye, ray, to, o.barDirection, end));
}

const uint kParts = 5;

// Blends the overlays over `behind` (light times opacity, and opacity), farthest first; those behind the surface at
// `surfaceDepth` are translucent.
vec4 overlaid(RenderView view, RenderOverlays o, vec2 place_px, float surfaceDepth, vec4 behind) {
  const vec3 inEye = rayThrough(view, place_px), ray = fromEye(view, inEye);
  const vec3 eye = view.eye + fromEye(view, rayFrom(view, place_px));
  Hit hits[kParts];
  for (uint k = 0; k < kParts; ++k) hits[k] = Hit(kMiss, vec3(0));
  if (o.ballRadius > 0) hits[0] = hitBall(eye, ray, o.ballCenter, o.ballRadius);
  if (o.discRadius > 0) hits[1] = hitThickDisc(eye, ray, o);
  if (o.arrowLength > 0) hits[2] = hitArrow(eye, ray, o);
  if (o.brushRadius > 0) hits[3] = hitOutline(view, eye, ray, o.brushCenter, o.brushRadius);
  if (o.barLength > 0) hits[4] = hitBar(eye, ray, o);
  const vec3 colors[kParts] = vec3[kParts](kBallColor, kDiscColor, kArrowColor, kBrushColor, o.barColor);
  for (uint layer = 0; layer < kParts; ++layer) {
    uint farthest = kParts;
    for (uint k = 0; k < kParts; ++k)
      if (hits[k].depth < kMiss && (farthest == kParts || hits[k].depth > hits[farthest].depth)) farthest = k;
    if (farthest == kParts) break;
    const vec3 color = lit(toLinear(colors[farthest]), toEye(view, hits[farthest].normal), -normalize(inEye), 1.0);
    const float opacity = hits[farthest].depth <= surfaceDepth ? 1.0 : kHiddenAlpha;
    behind = vec4(mix(behind.rgb, color, opacity), behind.a + (1 - behind.a) * opacity);
    hits[farthest].depth = kMiss;
  }
  return behind;
}

#endif
