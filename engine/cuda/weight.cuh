#pragma once

namespace palpate::cu {

/// Wendland's C2 function of r = distance / support radius, for r in [0, 1] (Wendland 1995): smooth where it ends, so
/// that force stays continuous when a point enters or leaves.
inline __device__ float wendland(float r) {
  const float s = 1.0f - r;
  const float s2 = s * s;
  return s2 * s2 * (4.0f * r + 1.0f);
}

}  // namespace palpate::cu
