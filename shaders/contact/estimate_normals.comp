#version 460
#extension GL_GOOGLE_include_directive : require
// For every point the normal of the plane that fits its neighbours. One invocation for each point: in hash order those
// of a subgroup visit the same cells.
#include "shaders/lib/index.glsl"
#include "shaders/lib/contact_buffers.glsl"
#include "shaders/shared/normal_estimate.h"
#include "shaders/shared/plane_fit.h"

layout(push_constant, scalar) uniform Push { NormalEstimateArgs args; };
#include "shaders/lib/bucket_share.glsl"

// Variances of the neighbours: off the plane, and along the shorter and the longer axis of their spread in it.
struct Spread {
  float off, along, farther;
};

Spread spreadAbout(Moments m, vec3 normal) {
  const mat3 covariance = covarianceOf(m);
  const vec3 u = besides(normal), v = cross(normal, u);
  const float uu = dot(u, covariance * u), vv = dot(v, covariance * v), uv = dot(u, covariance * v);
  const float middle = 0.5 * (uu + vv), apart = length(vec2(0.5 * (uu - vv), uv));
  return Spread(dot(normal, covariance * normal), middle - apart, middle + apart);
}

const Share kAll = Share(0, 1);

Moments momentsAbout(vec3 center, float radius, Share share, inout uint work) {
  const ivec3 low = cellOf(args.cloud.grid, center - radius);
  const ivec3 high = cellOf(args.cloud.grid, center + radius);
  Moments m = Moments(0.0, 0, vec3(0.0), vec3(0.0), vec3(0.0));
  for (int z = low.z; z <= high.z; ++z)
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x && work < kEstimateWorkBudget; ++x) {
        const ivec3 cell = ivec3(x, y, z);
        const uvec2 range = bucketWithin(cell, share, kEstimateWorkBudget, work);
        for (uint j = range.x; j < range.y; j += share.sharers) {
          const vec3 position = args.cloud.positions.at[j].xyz;
          const vec3 d = position - center;
          const float squared = dot(d, d);
          if (squared >= radius * radius || cellOf(args.cloud.grid, position) != cell) continue;
          addNeighbour(m, d, wendland(length(d) / radius));
        }
      }
  return m;
}

struct Fit {
  vec3 normal;
  float off;  // variance of the neighbours off the plane
};

// The plane of the neighbours, or if they are noisy that of a wider neighbourhood, if it is flatter; a zero normal if
// they lie on a line, around which single precision could rotate the plane.
Fit calmed(vec3 center, float radius, vec3 normal, Spread near, inout uint work) {
  if (near.along < kLineLike * near.farther) return Fit(vec3(0.0), 0.0);
  const Fit asIs = Fit(normal, near.off);
  if (near.off <= kCleanEstimate * near.along) return asIs;
  const Share everyOther = Share(0, 2);
  const Moments m = momentsAbout(center, kWiderEstimate * radius, everyOther, work);
  const vec3 wide = planeNormal(m);
  if (work >= kEstimateWorkBudget || dot(wide, wide) < 0.5) return asIs;
  const Spread far = spreadAbout(m, wide);
  return far.off * near.along < kFlatterEstimate * near.off * far.along ? Fit(wide, far.off) : asIs;
}

void main() {
  const uint i = threadIndex();
  if (i >= args.cloud.slots) return;
  const vec4 point = args.cloud.positions.at[i];
  const uint id = floatBitsToUint(point.w);
  if (id == kEmptySlot) return;
  uint work = 0;
  float radius = args.radius;
  Moments m;
  for (uint pass = 0; pass < kEstimatePasses; ++pass) {
    m = momentsAbout(point.xyz, radius, kAll, work);
    const bool few = m.neighbours < kFewestEstimated, many = m.neighbours > kMaxEstimated;
    if (pass + 1 == kEstimatePasses || work >= kEstimateWorkBudget || !few && !many) break;
    if (few && radius >= kWidestEstimate * args.radius) break;
    radius *= few ? 2.0 : sqrt(float(kWantedEstimated) / float(m.neighbours));
  }
  Fit fit = Fit(m.neighbours < kFewestEstimated ? vec3(0.0) : planeNormal(m), 0.0);
  if (dot(fit.normal, fit.normal) > 0.5) fit = calmed(point.xyz, radius, fit.normal, spreadAbout(m, fit.normal), work);
  if (work >= kEstimateWorkBudget) fit.normal = vec3(0.0);
  args.planes.at[id] = vec4(fit.normal, radius);
  args.fits.at[id] = vec2(max(fit.off, 0.0), 3.14159265 * radius * radius / float(max(m.neighbours, 1)));
}
