// From weighted sums over neighbours to the surface that they define: the formulas of shaders/lib/surface.glsl, for
// whoever sums.
#ifndef PALPATE_LIB_SURFACE_FIT_GLSL
#define PALPATE_LIB_SURFACE_FIT_GLSL

#include "shaders/shared/contact.h"

struct Surface {
  bool defined;
  float distance;  // signed, model units, positive outside
  vec3 normal;     // unit
  uint neighbours;
};

struct SurfaceSums {
  vec4 offsets;   // sum of w d, sum of w; d from the place to a neighbour, support radii
  vec4 normals;   // sum of w n, neighbours
  vec2 products;  // sum of w d.d, sum of w d.n
};

// The zero set of u(y) = u0 + ul.y + u4 y.y, y relative to the place: a sphere, or a plane where u4 = 0.
void fitSphere(SurfaceSums sums, inout Surface surface) {
  const float weights = sums.offsets.w;
  const float spread = sums.products.x / weights - dot(sums.offsets.xyz, sums.offsets.xyz) / (weights * weights);
  const float turn = sums.products.y / weights - dot(sums.offsets.xyz, sums.normals.xyz) / (weights * weights);
  const float strongest = 0.5 * kStrongestCurvature;
  const float u4 = clamp(0.5 * turn / (spread + kLeastSpread), -strongest, strongest);
  const vec3 ul = (sums.normals.xyz - 2.0 * u4 * sums.offsets.xyz) / weights;
  const float u0 = -(dot(ul, sums.offsets.xyz) + u4 * sums.products.x) / weights;
  const float slope = length(ul);
  surface.defined = slope > kLeastNormal;
  if (!surface.defined) return;
  surface.normal = ul / slope;
  // The nearer root, in the form that does not cancel where the sphere is almost a plane.
  surface.distance = 2.0 * u0 / (slope + sqrt(max(0.0, slope * slope - 4.0 * u0 * u4)));
}

// `kind`: kSurface...
Surface surfaceFrom(SurfaceSums sums, float radius, uint kind) {
  Surface surface = Surface(false, 0.0, vec3(0.0), uint(sums.normals.w));
  const float normalLength = length(sums.normals.xyz);
  surface.defined = surface.neighbours >= kMinNeighbours && normalLength > kLeastNormal * sums.offsets.w;
  if (!surface.defined) return surface;
  const vec3 mean = sums.offsets.xyz / sums.offsets.w;
  surface.normal = sums.normals.xyz / normalLength;
  surface.distance = -dot(surface.normal, mean);
  if (kind != kSurfaceAverage) fitSphere(sums, surface);
  const vec3 aside = mean - dot(mean, surface.normal) * surface.normal;
  if (!surface.defined || length(aside) >= kFurthestAside) return Surface(false, 0.0, vec3(0.0), surface.neighbours);
  surface.distance *= radius;
  return surface;
}

#endif
