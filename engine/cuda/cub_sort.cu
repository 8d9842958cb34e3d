// The sort of NVIDIA's library: least significant digit first, one sweep per digit (Adinets and Merrill 2022).
#include "engine/cuda/cub_sort.hpp"

#include <cub/device/device_radix_sort.cuh>

namespace palpate::cu {

namespace {

// Without scratch CUB only returns the required size.
unsigned sortOrMeasure(const PairBuffers& pairs, std::uint32_t count, unsigned keyBits, void* scratch,
                       std::size_t& scratchBytes, cudaStream_t stream) {
  cub::DoubleBuffer<std::uint32_t> keys(pairs.keys[0], pairs.keys[1]);
  cub::DoubleBuffer<std::uint32_t> values(pairs.values[0], pairs.values[1]);
  checkCuda(
      cub::DeviceRadixSort::SortPairs(scratch, scratchBytes, keys, values, count, 0, static_cast<int>(keyBits), stream),
      "sorting with CUB");
  return static_cast<unsigned>(keys.selector);
}

}  // namespace

std::size_t cubSortScratchBytes(std::uint32_t count, unsigned keyBits) {
  std::size_t bytes = 0;
  sortOrMeasure({}, count, keyBits, nullptr, bytes, nullptr);
  return bytes;
}

unsigned cubSort(const PairBuffers& pairs, std::uint32_t count, unsigned keyBits, void* scratch,
                 std::size_t scratchBytes, cudaStream_t stream) {
  if (count == 0 || keyBits == 0) return 0;
  return sortOrMeasure(pairs, count, keyBits, scratch, scratchBytes, stream);
}

}  // namespace palpate::cu
