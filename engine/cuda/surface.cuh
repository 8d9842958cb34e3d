// The implicit surface that the points of a patch define around a place (Leeper, Chan, Salisbury 2012; Adamson and
// Alexa 2003), as in shaders/lib/surface.glsl.
#pragma once

#include "engine/cuda/patch.cuh"
#include "engine/cuda/weight.cuh"

namespace palpate::cu {

struct Surface {
  bool defined;
  float distance;  // signed, model units, positive outside
  vec3 normal;     // unit
  uint neighbours;
};

/// The surface at `x`, relative to the patch's centre. All threads of the block call it together and get the same bits.
/// Every translation unit has its own: the device linker takes clones of one that they share for the same code.
static inline __device__ Surface surfaceAt(const Patch& patch, const vec3& x, float radius) {
  __shared__ float partial[kStepWarps][8];
  vec4 offsets(0.0f);  // sum of w (p - x), sum of w
  vec4 normals(0.0f);  // sum of w n, neighbours
  for (uint i = threadIdx.x; i < patch.count(); i += kStepThreads) {
    const vec3 d = patch.position(i) - x;
    const float squared = glm::dot(d, d);
    if (squared < radius * radius) {
      const float w = wendland(sqrtf(squared) / radius);
      offsets += w * vec4(d, 1.0f);
      normals += vec4(w * patch.normal(i), 1.0f);
    }
  }
  offsets = warpSum(offsets);
  normals = warpSum(normals);
  const uint warp = threadIdx.x / kWarp;
  if (threadIdx.x % kWarp == 0) {
    for (int k = 0; k < 4; ++k) {
      partial[warp][k] = offsets[k];
      partial[warp][4 + k] = normals[k];
    }
  }
  __syncthreads();
  offsets = normals = vec4(0.0f);
  for (uint w = 0; w < kStepWarps; ++w) {
    for (int k = 0; k < 4; ++k) {
      offsets[k] += partial[w][k];
      normals[k] += partial[w][4 + k];
    }
  }
  __syncthreads();  // the next evaluation writes the partial sums again

  Surface surface;
  surface.neighbours = uint(normals.w);
  const vec3 n(normals);
  const float normalLength = glm::length(n);
  surface.defined = surface.neighbours >= kMinNeighbours && normalLength > kLeastNormal * offsets.w && offsets.w > 0.0f;
  surface.normal = surface.defined ? n / normalLength : vec3(0.0f);
  const vec3 mean = surface.defined ? vec3(offsets) / offsets.w : vec3(0.0f);
  surface.distance = -glm::dot(surface.normal, mean);
  if (glm::length(mean + surface.distance * surface.normal) >= kFurthestAside * radius)
    return {.defined = false, .distance = 0.0f, .normal = vec3(0.0f), .neighbours = surface.neighbours};
  return surface;
}

}  // namespace palpate::cu
