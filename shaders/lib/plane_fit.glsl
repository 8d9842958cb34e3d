// The plane through the neighbours of a place, weighed by Wendland's function: its normal is the direction of least
// spread (Hoppe et al. 1992, section 3.2).
#ifndef PALPATE_LIB_PLANE_FIT_GLSL
#define PALPATE_LIB_PLANE_FIT_GLSL

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

Moments noMoments() { return Moments(0.0, 0, vec3(0.0), vec3(0.0), vec3(0.0)); }

void addNeighbour(inout Moments m, vec3 d, float w) {
  m.weight += w;
  m.neighbours += 1;
  m.mean += w * d;
  m.diagonal += w * d * d;
  m.mixed += w * d * d.yzx;
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
