#ifndef PALPATE_LIB_FRAME_GLSL
#define PALPATE_LIB_FRAME_GLSL

// Two unit vectors that complete the unit vector `n` to a right-handed frame (Duff et al. 2017), as frameAround() of
// engine/core/vec.hpp.
void frameAround(vec3 n, out vec3 u, out vec3 v) {
  const float sign = floatBitsToInt(n.z) < 0 ? -1 : 1;
  const float a = -1 / (sign + n.z);
  const float b = n.x * n.y * a;
  u = vec3(1 + sign * n.x * n.x * a, sign * b, -sign * n.x);
  v = vec3(b, sign + n.y * n.y * a, -n.y);
}

#endif
