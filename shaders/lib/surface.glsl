// The implicit surface that the points define around a place: signed distance and normal. Three kinds (SurfaceKind):
// the weighted average (Leeper, Chan, Salisbury 2012; Adamson and Alexa 2003), the algebraic sphere that fits places
// and normals (Guennebaud and Gross 2007; in closed form Guennebaud, Germann, Gross 2008), and that sphere with weights
// that let go of points across an edge (Oztireli, Guennebaud, Gross 2009). engine/contact/surface_reference.cpp is the
// same in double precision. Sums are relative to the place and in support radii: their differences are small.
#ifndef PALPATE_LIB_SURFACE_GLSL
#define PALPATE_LIB_SURFACE_GLSL

#extension GL_EXT_control_flow_attributes : require

#include "shaders/lib/patch.glsl"
#include "shaders/lib/subgroup_sum.glsl"
#include "shaders/lib/surface_fit.glsl"
#include "shaders/lib/weight.glsl"

layout(constant_id = 1) const uint kSurface = kSurfaceAverage;
layout(constant_id = 2) const bool kLocalRadius = false;

// Sums of subgroups that an invocation asks for at once; a workgroup has a multiple of so many.
const uint kPartialsInFlight = 2;

shared vec4 partialOffsets[kMaxSubgroups];
shared vec4 partialNormals[kMaxSubgroups];
shared vec4 partialProducts[kMaxSubgroups];  // xy

// What all invocations have summed up, the same bits for each. All of them call it together.
SurfaceSums sumOfAll(SurfaceSums sums) {
  const float offset = subgroupComponentSum(sums.offsets);
  const float normal = subgroupComponentSum(sums.normals);
  float product = 0.0;
  if (kSurface != kSurfaceAverage) product = subgroupComponentSum(vec4(sums.products, 0.0, 0.0));
  barrier();
  if (gl_SubgroupInvocationID < 4) {
    partialOffsets[gl_SubgroupID][gl_SubgroupInvocationID] = offset;
    partialNormals[gl_SubgroupID][gl_SubgroupInvocationID] = normal;
    partialProducts[gl_SubgroupID][gl_SubgroupInvocationID] = product;
  }
  barrier();
  sums = SurfaceSums(vec4(0.0), vec4(0.0), vec2(0.0));
  for (uint s = 0; s < gl_NumSubgroups; s += kPartialsInFlight) {
    [[unroll]] for (uint i = 0; i < kPartialsInFlight; ++i) {
      sums.offsets += partialOffsets[s + i];
      sums.normals += partialNormals[s + i];
      if (kSurface != kSurfaceAverage) sums.products += partialProducts[s + i].xy;
    }
  }
  workDone += patchCount / kContactWorkgroup + 1 + gl_NumSubgroups;
  return sums;
}

// The support radius that holds kSupportSpacings local spacings, as far as `radius` reaches: on an even plane the
// weights sum up to pi / 7 points of the disc. Looks twice, since the first look averages the density over the whole
// radius; the second may only widen.
float localRadiusAt(SpilledPoints spill, vec3 x, float radius) {
  float smallest = kLeastLocalRadius * radius;
  float local = radius;
  for (uint look = 0; look < 2; ++look) {
    SurfaceSums sums = SurfaceSums(vec4(0.0), vec4(0.0), vec2(0.0));
    for (uint i = scanIndex(); i < patchCount; i += kContactWorkgroup) {
      const float r = distance(patchPosition(spill, i), x) / local;
      if (r < 1.0) sums.offsets.w += wendland(r);
    }
    const float weights = sumOfAll(sums).offsets.w;
    const float spacings = kSupportSpacings * local * sqrt(0.448798951 / max(weights, 1e-30));
    smallest = local = clamp(spacings, smallest, radius);
  }
  return local;
}

float robustWeight(Surface before, float radius, vec3 d, vec3 n) {
  const vec3 turn = (n - before.normal) / kSharpNormal;
  const float height = (-dot(d, n) - before.distance / radius) / kSharpHeight;
  return exp(-dot(turn, turn) - height * height);
}

// The surface at `x`, relative to the patch's centre, of the points that face the side `facing`, or of all where that
// is zero. All invocations call it together and get the same answer.
Surface surfaceAt(SpilledPoints spill, vec3 x, float largestRadius, vec3 facing) {
  const float radius = kLocalRadius ? localRadiusAt(spill, x, largestRadius) : largestRadius;
  const uint passes = kSurface == kSurfaceSharp ? kSharpPasses : 1;
  const bool sided = facing != vec3(0.0);
  Surface surface;
  for (uint pass = 0; pass < passes; ++pass) {
    SurfaceSums sums = SurfaceSums(vec4(0.0), vec4(0.0), vec2(0.0));
    for (uint i = scanIndex(); i < patchCount; i += kContactWorkgroup) {
      const vec3 d = (patchPosition(spill, i) - x) / radius;
      const float squared = dot(d, d);
      if (squared >= 1.0) continue;
      const vec3 n = patchNormal(spill, i);
      float w = wendland(sqrt(squared));
      if (sided) w *= clamp(1.0 + 2.0 * dot(n, facing), 0.0, 1.0);
      if (pass > 0) w *= robustWeight(surface, radius, d, n);
      if (w <= 0.0) continue;
      sums.offsets += w * vec4(d, 1.0);
      sums.normals += vec4(w * n, 1.0);
      if (kSurface != kSurfaceAverage) sums.products += w * vec2(squared, dot(d, n));
    }
    surface = surfaceFrom(sumOfAll(sums), radius, kSurface);
    if (!surface.defined) break;
  }
  return surface;
}

#endif
