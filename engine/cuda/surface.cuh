// The averaged surface of the points of a patch around a position (shaders/shared/surface.h), summed by one block.
#pragma once

#include "engine/cuda/patch.cuh"
#include "shaders/shared/surface.h"

namespace palpate::cu {

using Surface = shared::SurfaceOf<float>;
using SurfaceSums = shared::SurfaceSumsOf<float>;

/// The surface at `x`, relative to the patch's centre, from the points of the face with the normal `facing`, or from
/// all if that is zero. All threads of the block must call it together and get the same bits. Each translation unit has
/// its own copy: the device linker confuses the clones of a shared one.
static inline __device__ Surface surfaceAt(const Patch& patch, const vec3& x, float radius, const vec3& facing) {
  __shared__ float partial[kStepWarps][8];
  const bool sided = facing != vec3(0.0f);
  const float scale = 1.0f / radius;
  SurfaceSums sums{vec4(0.0f), vec4(0.0f), vec2(0.0f)};
  for (uint i = threadIdx.x; i < patch.count(); i += kStepThreads) {
    const vec3 d = (patch.position(i) - x) * scale, n = patch.normal(i);
    float w = wendland(min(1.0f, length(d)));
    if (sided) w *= facingWeight(dot(n, facing));
    sums.offsets += w * vec4(d, 1.0f);
    sums.normals += vec4(w * n, w > 0.0f ? 1.0f : 0.0f);
  }
  sums.offsets = warpSum(sums.offsets);
  sums.normals = warpSum(sums.normals);
  const uint warp = threadIdx.x / kWarp;
  if (threadIdx.x % kWarp == 0) {
    for (int k = 0; k < 4; ++k) {
      partial[warp][k] = sums.offsets[k];
      partial[warp][4 + k] = sums.normals[k];
    }
  }
  __syncthreads();
  sums.offsets = sums.normals = vec4(0.0f);
  for (uint w = 0; w < kStepWarps; ++w) {
    for (int k = 0; k < 4; ++k) {
      sums.offsets[k] += partial[w][k];
      sums.normals[k] += partial[w][4 + k];
    }
  }
  __syncthreads();  // the next evaluation overwrites the partial sums
  return surfaceFrom(sums, radius, kSurfaceAverage);
}

}  // namespace palpate::cu
