// The surface at a position from the points around it: that of contact (shaders/shared/surface.h), or the level set
// where the density of the points (thesis, equation 3.1) falls to a given value.
#ifndef PALPATE_MESH_FIELD_GLSL
#define PALPATE_MESH_FIELD_GLSL

#include "shaders/mesh/lattice.glsl"
// After the buffer references of contact.
#include "shaders/shared/surface.h"

layout(constant_id = 1) const uint kMeshSurface = kSurfaceSphere;

const uint kFieldPasses = kMeshSurface == kSurfaceSharp ? kSharpPasses : 1;

struct FieldSums {
  SurfaceSums surface;
  vec3 slope;  // of the density, inwards, any length
};
FieldSums noSums() { return FieldSums(SurfaceSums(vec4(0.0), vec4(0.0), vec2(0.0)), vec3(0.0)); }

const Surface kNoSurface = Surface(false, 0.0, vec3(0.0), 0, false);

// Adds a point that is `d` support radii away, and returns its weight: zero if the distance is one or more, and then
// nothing changes. `before`: result of the previous pass; undefined in the first one.
float addPoint(inout FieldSums sums, vec3 d, vec3 n, Surface before) {
  const float squared = dot(d, d);
  const float r = min(sqrt(squared), 1.0);
  float w = wendland(r);
  if (before.defined) w *= robustWeight(before.normal, before.distance / args.lattice.radius, d, n);
  sums.surface.offsets += w * vec4(d, 1.0);
  sums.surface.normals += vec4(w * n, w > 0.0 ? 1.0 : 0.0);
  sums.surface.products += w * vec2(squared, dot(d, n));
  if (kMeshSurface == kSurfaceDensity) sums.slope += (1.0 - r) * (1.0 - r) * (1.0 - r) * d;
  return w;
}

// The surface of one pass: signed distance, model units, and unit normal, zero if there is none.
Surface surfaceOf(FieldSums sums) {
  if (kMeshSurface != kSurfaceDensity) return surfaceFrom(sums.surface, args.lattice.radius, kMeshSurface);
  const float density = sums.surface.offsets.w * args.lattice.densityScale;
  const float steep = length(sums.slope);
  return Surface(true, (kMeshIsoDensity - density) * args.lattice.radius,
                 steep > 0.0 ? -sums.slope / steep : vec3(0.0), 0, false);
}

// If cells hold too many candidates, they are subsampled with this stride.
uint strideFor(uint candidates) { return 1 + (max(candidates, 1) - 1) / kMeshMaxCandidates; }

#endif
