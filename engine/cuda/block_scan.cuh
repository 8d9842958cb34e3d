// Sums and prefix sums over one block of kContactWorkgroup threads. All threads of the block must call them together.
#pragma once

#include "shaders/shared/contact.h"

namespace palpate::cu {

inline constexpr unsigned kStepThreads = shared::kContactWorkgroup;
inline constexpr unsigned kWarp = 32;
inline constexpr unsigned kStepWarps = kStepThreads / kWarp;
inline constexpr unsigned kAllLanes = 0xFFFFFFFFu;

/// Sum over the warp, bitwise identical in every lane: at each level both partners add the same two numbers.
template <class T>
__device__ T warpSum(T value) {
  for (unsigned apart = kWarp / 2; apart > 0; apart /= 2) value += __shfl_xor_sync(kAllLanes, value, apart);
  return value;
}
inline __device__ shared::vec3 warpSum(const shared::vec3& v) { return {warpSum(v.x), warpSum(v.y), warpSum(v.z)}; }
inline __device__ shared::vec4 warpSum(const shared::vec4& v) {
  return {warpSum(v.x), warpSum(v.y), warpSum(v.z), warpSum(v.w)};
}

/// Sum of `value` over the threads before this one; `total` over all.
inline __device__ unsigned blockExclusiveScan(unsigned value, unsigned& total) {
  __shared__ unsigned warpTotals[kStepWarps];
  const unsigned lane = threadIdx.x % kWarp, warp = threadIdx.x / kWarp;
  unsigned inclusive = value;
  for (unsigned apart = 1; apart < kWarp; apart *= 2) {
    const unsigned before = __shfl_up_sync(kAllLanes, inclusive, apart);
    if (lane >= apart) inclusive += before;
  }
  if (lane == kWarp - 1) warpTotals[warp] = inclusive;
  __syncthreads();
  unsigned before = 0;
  total = 0;
  for (unsigned w = 0; w < kStepWarps; ++w) {
    const unsigned sum = warpTotals[w];
    before += w < warp ? sum : 0;
    total += sum;
  }
  __syncthreads();  // the next call overwrites the totals
  return before + inclusive - value;
}

/// Maximum of all threads' values.
inline __device__ unsigned blockMax(unsigned value) {
  __shared__ unsigned warpLargest[kStepWarps];
  const unsigned largest = __reduce_max_sync(kAllLanes, value);
  if (threadIdx.x % kWarp == 0) warpLargest[threadIdx.x / kWarp] = largest;
  __syncthreads();
  unsigned all = 0;
  for (unsigned w = 0; w < kStepWarps; ++w) all = max(all, warpLargest[w]);
  __syncthreads();
  return all;
}

}  // namespace palpate::cu
