// The surface of the patch around a position (shaders/shared/surface.h), summed up by a workgroup.
#ifndef PALPATE_LIB_SURFACE_GLSL
#define PALPATE_LIB_SURFACE_GLSL

#extension GL_EXT_control_flow_attributes : require

#include "shaders/lib/patch.glsl"
#include "shaders/lib/subgroup_sum.glsl"
#include "shaders/shared/surface.h"

layout(constant_id = 1) const uint kSurface = kSurfaceAverage;
layout(constant_id = 2) const bool kLocalRadius = false;
layout(constant_id = 5) const float kWidening = 1.0;  // SurfaceOptions::widening

// Sums of subgroups that an invocation loads at once; the number of subgroups is a multiple of it.
const uint kPartialsInFlight = 2;

shared vec4 partialOffsets[kMaxSubgroups];
shared vec4 partialNormals[kMaxSubgroups];
shared vec4 partialProducts[kMaxSubgroups];  // xy

// Points of the patch that an invocation visits side by side, so that their latencies overlap.
const uint kPatchInFlight = 4;
// Rounds in which each subgroup sums up a small patch alone, all with the same result, so that no subgroup waits for
// others.
const uint kRoundsAlone = 8;

bool sumsAlone() { return patchCount <= kRoundsAlone * gl_SubgroupSize; }
// The points that an invocation sums up: from the first on every summedStride()-th.
uint firstSummed() { return sumsAlone() ? gl_SubgroupInvocationID : scanIndex(); }
uint summedStride() { return sumsAlone() ? gl_SubgroupSize : kContactWorkgroup; }

// The points that an invocation visits side by side; past the end of the patch, its last one. Those in shared memory
// are loaded without a branch for each.
void loadPoints(SpilledPoints spill, uint first, out vec3 positions[kPatchInFlight],
                out vec3 normals[kPatchInFlight]) {
  [[unroll]] for (uint k = 0; k < kPatchInFlight; ++k) {
    const uint held = min(first + k * summedStride(), min(patchCount, kSharedPatch) - 1);
    positions[k] = patchPositions[held];
    normals[k] = patchNormals[held];
  }
  if (patchCount <= kSharedPatch) return;
  [[unroll]] for (uint k = 0; k < kPatchInFlight; ++k) {
    const uint i = min(first + k * summedStride(), patchCount - 1);
    if (i < kSharedPatch) continue;
    positions[k] = spill.at[spilledAt(i)].xyz;
    normals[k] = spill.at[spilledAt(i) + 1].xyz;
  }
}

// The sums of all invocations, bitwise the same for each. All of them call it together.
SurfaceSums sumOfAll(SurfaceSums sums) {
  if (sumsAlone()) {
    workDone += kRoundsAlone;
    sums.offsets = subgroupSum(sums.offsets);
    sums.normals = subgroupSum(sums.normals);
    if (kSurface != kSurfaceAverage) sums.products = subgroupSum(vec4(sums.products, 0.0, 0.0)).xy;
    return sums;
  }
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

// The support radius that holds kSupportSpacings local spacings, limited to `radius`. Two passes, since the first
// averages the density over the whole radius; the second can only widen.
float localRadiusAt(SpilledPoints spill, vec3 x, float radius) {
  float smallest = kMinLocalRadius * radius;
  float local = radius;
  for (uint pass = 0; pass < 2; ++pass) {
    SurfaceSums sums = SurfaceSums(vec4(0.0), vec4(0.0), vec2(0.0));
    for (uint i = firstSummed(); i < patchCount; i += summedStride()) {
      const float r = distance(patchPosition(spill, i), x) / local;
      if (r < 1.0) sums.offsets.w += wendland(r);
    }
    const float weights = sumOfAll(sums).offsets.w;
    smallest = local = localRadius(local, weights, smallest, radius);
  }
  return local;
}

// A radius between `narrow` and the widened one: wide where the normals within the widened one agree, of points that
// belong to the face `facing`.
float wideWhereFlatAt(SpilledPoints spill, vec3 x, float narrow, vec3 facing) {
  const float wide = kWidening * narrow;
  const bool sided = facing != vec3(0.0);
  SurfaceSums sums = SurfaceSums(vec4(0.0), vec4(0.0), vec2(0.0));
  for (uint i = firstSummed(); i < patchCount; i += summedStride()) {
    const float r = distance(patchPosition(spill, i), x) / wide;
    if (r >= 1.0) continue;
    const vec3 n = patchNormal(spill, i);
    float w = wendland(r);
    if (sided) w *= turnWeight(kSurface, dot(n, facing));
    sums.offsets.w += w;
    sums.normals.xyz += w * n;
  }
  sums = sumOfAll(sums);
  return wideWhereFlat(narrow, wide, length(sums.normals.xyz) / max(sums.offsets.w, 1e-30));
}

// The velocity of the surface at `x`, relative to the patch's centre: the mean of those of the points within the
// support radius that belong to the face with the normal `facing`.
vec3 velocityAt(SpilledPoints spill, Vec4s velocities, vec3 x, float radius, vec3 facing) {
  SurfaceSums sums = SurfaceSums(vec4(0.0), vec4(0.0), vec2(0.0));
  for (uint i = firstSummed(); i < patchCount; i += summedStride()) {
    const float r = distance(patchPosition(spill, i), x) / radius;
    if (r >= 1.0) continue;
    const float w = wendland(r) * facingWeight(dot(patchNormal(spill, i), facing));
    const vec4 velocity = velocities.at[patchId(spill, i)];
    sums.offsets += w * vec4(velocity.w, 0.0, 0.0, 1.0);
    sums.normals.xyz += w * velocity.xyz;
  }
  sums = sumOfAll(sums);
  if (!(sums.offsets.w > 0.0)) return vec3(0.0);
  return knownVelocity(sums.normals.xyz / sums.offsets.w, facing, sums.offsets.x / sums.offsets.w);
}

// The surface at `x`, relative to the patch's centre, of the points of the face with the normal `facing`, or of all
// points if that is zero. All invocations call it together and get the same answer.
Surface surfaceAt(SpilledPoints spill, vec3 x, float largestRadius, vec3 facing) {
  float radius = largestRadius / kWidening;
  if (kLocalRadius) radius = localRadiusAt(spill, x, radius);
  if (kWidening > 1.0) radius = wideWhereFlatAt(spill, x, radius, facing);
  const uint passes = kSurface == kSurfaceSharp ? kSharpPasses : 1;
  const bool sided = facing != vec3(0.0);
  const float scale = 1.0 / radius;
  Surface surface;
  for (uint pass = 0; pass < passes; ++pass) {
    SurfaceSums sums = SurfaceSums(vec4(0.0), vec4(0.0), vec2(0.0));
    for (uint first = firstSummed(); first < patchCount; first += kPatchInFlight * summedStride()) {
      vec3 positions[kPatchInFlight], normals[kPatchInFlight];
      loadPoints(spill, first, positions, normals);
      [[unroll]] for (uint k = 0; k < kPatchInFlight; ++k) {
        const uint i = first + k * summedStride();
        const vec3 d = (positions[k] - x) * scale, n = normals[k];
        const float squared = dot(d, d);
        float w = i < patchCount ? wendland(min(1.0, sqrt(squared))) : 0.0;
        if (sided) w *= facingWeight(dot(n, facing));
        if (pass > 0) w *= robustWeight(surface.normal, surface.distance / radius, d, n);
        sums.offsets += w * vec4(d, 1.0);
        sums.normals += vec4(w * n, w > 0.0 ? 1.0 : 0.0);
        if (kSurface != kSurfaceAverage) sums.products += w * vec2(squared, dot(d, n));
      }
    }
    surface = surfaceFrom(sumOfAll(sums), radius, kSurface);
    if (!surface.defined) break;
  }
  return surface;
}

#endif
