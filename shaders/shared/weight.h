// How much a neighbour counts, and what the weights of all of them say of their density.
#ifndef PALPATE_SHARED_WEIGHT_H
#define PALPATE_SHARED_WEIGHT_H
#include "shaders/shared/real.h"

PALPATE_SHARED_BEGIN

// Wendland's C2 function of r = distance / support radius, for r in [0, 1] (Wendland 1995): smooth where it ends, so
// that force stays continuous when a point enters or leaves.
PALPATE_FORMULA Real wendland(Real r) {
  const Real s = Real(1.0) - r;
  const Real s2 = s * s;
  return s2 * s2 * (Real(4.0) * r + Real(1.0));
}

// How much a point counts whose normal's cosine to the felt face is `cosine`: all up to 90 degrees, nothing from 120
// degrees on, so that the far face of a thin sheet is not felt through it.
PALPATE_FORMULA Real facingWeight(Real cosine) { return clamp(Real(1.0) + Real(2.0) * cosine, Real(0.0), Real(1.0)); }

// The spacing of points whose weights within `radius` sum up to `weights`: on an even plane they sum up to
// pi / 7 (radius / spacing)^2. In the unit of the radius.
PALPATE_FORMULA Real spacingFrom(Real radius, Real weights) {
  return radius * sqrt(Real(0.448798950512827605) / weights);
}

PALPATE_SHARED_END
#endif
