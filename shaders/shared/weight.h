// Weights of neighbours, and the local spacing that follows from their sum.
#ifndef PALPATE_SHARED_WEIGHT_H
#define PALPATE_SHARED_WEIGHT_H
#include "shaders/shared/real.h"

PALPATE_SHARED_BEGIN

// Wendland's C2 function of r = distance / support radius, for r in [0, 1] (Wendland 1995): smooth at r = 1, so that
// force stays continuous when a point enters or leaves.
PALPATE_FORMULA Real wendland(Real r) {
  const Real s = Real(1.0) - r;
  const Real s2 = s * s;
  return s2 * s2 * (Real(4.0) * r + Real(1.0));
}

// Weight of a point by the cosine of the angle between its normal and the felt face: 1 up to 90 degrees, 0 from 120
// degrees on, so that the far face of a thin sheet is not felt through it.
PALPATE_FORMULA Real facingWeight(Real cosine) { return clamp(Real(1.0) + Real(2.0) * cosine, Real(0.0), Real(1.0)); }

// Spacing of points whose weights within `radius` sum up to `weights`, in the unit of the radius: on an even plane the
// sum is pi / 7 (radius / spacing)^2.
PALPATE_FORMULA Real spacingFrom(Real radius, Real weights) {
  return radius * sqrt(Real(0.448798950512827605) / weights);
}

PALPATE_SHARED_END
#endif
