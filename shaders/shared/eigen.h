#ifndef PALPATE_SHARED_EIGEN_H
#define PALPATE_SHARED_EIGEN_H
#include "shaders/shared/real.h"

PALPATE_SHARED_BEGIN

// Unit eigenvector of the smallest eigenvalue of a symmetric matrix, in closed form (Smith 1961 for the eigenvalue; the
// vector is the longest cross product of two rows of A - lambda I). Zero when no direction of the matrix stands out.
PALPATE_FORMULA PALPATE_VEC3 smallestEigenvector(PALPATE_MAT3 a) {
  const Real third = (a[0][0] + a[1][1] + a[2][2]) / Real(3.0);
  const PALPATE_MAT3 b = a - PALPATE_MAT3(third);
  const Real spread = sqrt((dot(b[0], b[0]) + dot(b[1], b[1]) + dot(b[2], b[2])) / Real(6.0));
  if (!(spread > Real(1e-6) * third)) return PALPATE_VEC3(Real(0.0));
  const Real angle = acos(clamp(determinant(b / spread) * Real(0.5), Real(-1.0), Real(1.0))) / Real(3.0);
  const Real twoThirdsPi = Real(2.0943951);
  const Real lambda = Real(2.0) * spread * cos(angle + twoThirdsPi);  // of b
  const PALPATE_MAT3 m = b - PALPATE_MAT3(lambda);
  const PALPATE_VEC3 c0 = cross(m[0], m[1]);
  const PALPATE_VEC3 c1 = cross(m[1], m[2]);
  const PALPATE_VEC3 c2 = cross(m[2], m[0]);
  const Real l0 = dot(c0, c0);
  const Real l1 = dot(c1, c1);
  const Real l2 = dot(c2, c2);
  const Real longest = max(l0, max(l1, l2));
  const Real tiny = Real(1e-5) * spread * spread;
  if (!(longest > tiny * tiny)) return PALPATE_VEC3(Real(0.0));  // points on a line
  return longest == l0 ? c0 / sqrt(l0) : longest == l1 ? c1 / sqrt(l1) : c2 / sqrt(l2);
}

PALPATE_SHARED_END
#endif
