#ifndef PALPATE_LIB_EIGEN_GLSL
#define PALPATE_LIB_EIGEN_GLSL

// Unit eigenvector of the smallest eigenvalue of a symmetric matrix, in closed form (Smith 1961 for the eigenvalue;
// the vector is the longest cross product of two rows of A - lambda I). Zero when the matrix has no direction that
// stands out.
vec3 smallestEigenvector(mat3 a) {
  const float third = (a[0][0] + a[1][1] + a[2][2]) / 3.0;
  const mat3 b = a - mat3(third);
  const float spread = sqrt((dot(b[0], b[0]) + dot(b[1], b[1]) + dot(b[2], b[2])) / 6.0);
  if (!(spread > 1e-6 * third)) return vec3(0.0);
  const float angle = acos(clamp(determinant(b / spread) * 0.5, -1.0, 1.0)) / 3.0;
  const float kTwoThirdsPi = 2.0943951;
  const float lambda = 2.0 * spread * cos(angle + kTwoThirdsPi);  // of b
  const mat3 m = b - mat3(lambda);
  const vec3 c0 = cross(m[0], m[1]);
  const vec3 c1 = cross(m[1], m[2]);
  const vec3 c2 = cross(m[2], m[0]);
  const float l0 = dot(c0, c0);
  const float l1 = dot(c1, c1);
  const float l2 = dot(c2, c2);
  const float longest = max(l0, max(l1, l2));
  const float tiny = 1e-5 * spread * spread;
  if (!(longest > tiny * tiny)) return vec3(0.0);  // points on a line
  return longest == l0 ? c0 / sqrt(l0) : longest == l1 ? c1 / sqrt(l1) : c2 / sqrt(l2);
}

#endif
