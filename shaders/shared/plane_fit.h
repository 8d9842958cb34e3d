// The plane through the neighbours of a position, weighted by Wendland's function: its normal is the direction of least
// spread (Hoppe et al. 1992, section 3.2). engine/edit/normal_fit.hpp computes the same in double precision, by Jacobi
// rotations.
#ifndef PALPATE_SHARED_PLANE_FIT_H
#define PALPATE_SHARED_PLANE_FIT_H
#include "shaders/shared/contact.h"
#include "shaders/shared/eigen.h"
#include "shaders/shared/weight.h"

PALPATE_SHARED_BEGIN

// Weighted moments of the neighbours about a position.
PALPATE_STRUCT(Moments) {
  Real weight;
  uint neighbours;
  PALPATE_VEC3 mean;      // sum of w d
  PALPATE_VEC3 diagonal;  // sums of w dx dx, w dy dy, w dz dz
  PALPATE_VEC3 mixed;     // sums of w dx dy, w dy dz, w dz dx
};
PALPATE_SINGLE(Moments);

PALPATE_FORMULA PALPATE_VEC3 turned(PALPATE_VEC3 v) { return PALPATE_VEC3(v.y, v.z, v.x); }

PALPATE_FORMULA void addNeighbour(PALPATE_INOUT(PALPATE_OF(Moments)) m, PALPATE_VEC3 d, Real w) {
  m.weight += w;
  m.neighbours += 1u;
  m.mean += w * d;
  m.diagonal += w * d * d;
  m.mixed += w * d * turned(d);
}

// A unit vector in the plane of a unit normal.
PALPATE_FORMULA PALPATE_VEC3 besides(PALPATE_VEC3 normal) {
  const bool along = abs(normal.x) < Real(0.6);
  return normalize(along ? cross(normal, PALPATE_VEC3(1, 0, 0)) : cross(normal, PALPATE_VEC3(0, 1, 0)));
}

PALPATE_FORMULA PALPATE_MAT3 covarianceOf(PALPATE_OF(Moments) m) {
  const PALPATE_VEC3 mean = m.mean / m.weight;
  const PALPATE_VEC3 diagonal = m.diagonal / m.weight - mean * mean;
  const PALPATE_VEC3 mixed = m.mixed / m.weight - mean * turned(mean);
  return PALPATE_MAT3(diagonal.x, mixed.x, mixed.z,  //
                      mixed.x, diagonal.y, mixed.y,  //
                      mixed.z, mixed.y, diagonal.z);
}

// Unit, of either sign; zero where there are too few neighbours, or where they do not spread over a surface.
PALPATE_FORMULA PALPATE_VEC3 planeNormal(PALPATE_OF(Moments) m) {
  if (m.neighbours < kMinNeighbours || m.weight <= Real(0.0)) return PALPATE_VEC3(Real(0.0));
  return smallestEigenvector(covarianceOf(m));
}

PALPATE_SHARED_END
#endif
