// The plane through the neighbours of a place, weighed by Wendland's function: its normal is the direction of least
// spread (Hoppe et al. 1992, section 3.2). One invocation looks at every neighbour, or some share them.
#ifndef PALPATE_LIB_PLANE_FIT_GLSL
#define PALPATE_LIB_PLANE_FIT_GLSL

#include "shaders/lib/contact_buffers.glsl"
#include "shaders/lib/eigen.glsl"
#include "shaders/lib/weight.glsl"

// Weighted moments of the neighbours about a place.
struct Moments {
  float weight;
  uint neighbours;
  vec3 mean;      // sum of w d
  vec3 diagonal;  // sums of w dx dx, w dy dy, w dz dz
  vec3 mixed;     // sums of w dx dy, w dy dz, w dz dx
};

// Which points of a bucket an invocation looks at, where `sharers` share them.
struct Share {
  uint own, sharers;
};

// The points of a bucket that are still looked at. `work`: rounds so far; none are left at `budget`.
uvec2 bucketWithin(CloudView cloud, ivec3 cell, Share share, uint budget, inout uint work) {
  const uvec2 range = cloud.ranges.at[bucketOf(cloud.grid, cell)];
  const uint rounds = min((range.y - range.x + share.sharers - 1) / share.sharers, budget - min(work, budget));
  work += 1 + rounds;
  return uvec2(range.x + share.own, min(range.y, range.x + rounds * share.sharers));
}

Moments momentsAbout(CloudView cloud, vec3 center, float radius, Share share, uint budget, inout uint work) {
  const ivec3 low = cellOf(cloud.grid, center - radius);
  const ivec3 high = cellOf(cloud.grid, center + radius);
  Moments m = Moments(0.0, 0, vec3(0.0), vec3(0.0), vec3(0.0));
  for (int z = low.z; z <= high.z; ++z)
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x; ++x) {
        const ivec3 cell = ivec3(x, y, z);
        const uvec2 range = bucketWithin(cloud, cell, share, budget, work);
        for (uint j = range.x; j < range.y; j += share.sharers) {
          const vec3 position = cloud.positions.at[j].xyz;
          const vec3 d = position - center;
          const float squared = dot(d, d);
          if (squared >= radius * radius || cellOf(cloud.grid, position) != cell) continue;
          const float w = wendland(sqrt(squared) / radius);
          m.weight += w;
          m.neighbours += 1;
          m.mean += w * d;
          m.diagonal += w * d * d;
          m.mixed += w * d * d.yzx;
        }
      }
  return m;
}

// A unit vector in the plane of a unit normal.
vec3 besides(vec3 normal) {
  return normalize(abs(normal.x) < 0.6 ? cross(normal, vec3(1, 0, 0)) : cross(normal, vec3(0, 1, 0)));
}

mat3 covarianceOf(Moments m) {
  const vec3 mean = m.mean / m.weight;
  const vec3 diagonal = m.diagonal / m.weight - mean * mean;
  const vec3 mixed = m.mixed / m.weight - mean * mean.yzx;
  return mat3(diagonal.x, mixed.x, mixed.z,  //
              mixed.x, diagonal.y, mixed.y,  //
              mixed.z, mixed.y, diagonal.z);
}

// Unit, of either sign; zero where the neighbours are too few to say, or do not spread over a surface.
vec3 planeNormal(Moments m) {
  if (m.neighbours < kMinNeighbours || m.weight <= 0.0) return vec3(0.0);
  return smallestEigenvector(covarianceOf(m));
}

#endif
