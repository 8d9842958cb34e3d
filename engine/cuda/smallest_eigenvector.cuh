#pragma once

#include <glm/matrix.hpp>

#include "shaders/shared/types.h"

namespace palpate::cu {

/// Unit eigenvector of the smallest eigenvalue of a symmetric matrix, in closed form (Smith 1961 for the eigenvalue;
/// the vector is the longest cross product of two rows of A - lambda I). Zero when no direction stands out. The same as
/// shaders/lib/eigen.glsl.
inline __device__ shared::vec3 smallestEigenvector(const glm::mat3& a) {
  using shared::vec3;
  const float third = (a[0][0] + a[1][1] + a[2][2]) / 3.0f;
  const glm::mat3 b = a - glm::mat3(third);
  const float spread = sqrtf((glm::dot(b[0], b[0]) + glm::dot(b[1], b[1]) + glm::dot(b[2], b[2])) / 6.0f);
  if (!(spread > 1e-6f * third)) return vec3(0.0f);
  const float cosine = fminf(fmaxf(glm::determinant(b / spread) * 0.5f, -1.0f), 1.0f);
  constexpr float kTwoThirdsPi = 2.0943951f;
  const float lambda = 2.0f * spread * cosf(acosf(cosine) / 3.0f + kTwoThirdsPi);  // of b
  const glm::mat3 m = b - glm::mat3(lambda);
  const vec3 crosses[3] = {glm::cross(m[0], m[1]), glm::cross(m[1], m[2]), glm::cross(m[2], m[0])};
  vec3 longest = crosses[0];
  float longestSquared = glm::dot(longest, longest);
  for (int k = 1; k < 3; ++k) {
    const float squared = glm::dot(crosses[k], crosses[k]);
    if (squared > longestSquared) {
      longest = crosses[k];
      longestSquared = squared;
    }
  }
  const float tiny = 1e-5f * spread * spread;
  if (!(longestSquared > tiny * tiny)) return vec3(0.0f);  // points on a line
  return longest / sqrtf(longestSquared);
}

}  // namespace palpate::cu
