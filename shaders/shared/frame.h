#ifndef PALPATE_SHARED_FRAME_H
#define PALPATE_SHARED_FRAME_H
#include "shaders/shared/real.h"

PALPATE_SHARED_BEGIN

// Two unit vectors that complete the unit vector `n` to a right-handed frame (Duff et al. 2017). The frame flips where
// the sign of n.z changes; -0 counts as negative.
PALPATE_FORMULA void frameAround(PALPATE_VEC3 n, PALPATE_OUT(PALPATE_VEC3) u, PALPATE_OUT(PALPATE_VEC3) v) {
  const Real sign = isNegative(n.z) ? Real(-1.0) : Real(1.0);
  const Real a = Real(-1.0) / (sign + n.z);
  const Real b = n.x * n.y * a;
  u = PALPATE_VEC3(Real(1.0) + sign * n.x * n.x * a, sign * b, -sign * n.x);
  v = PALPATE_VEC3(b, sign + n.y * n.y * a, -n.y);
}

PALPATE_SHARED_END

#endif
