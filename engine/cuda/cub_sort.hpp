// CUB's radix sort of (key, number) pairs, behind a plain function so that only one file compiles CUB.
#pragma once

#include <cstddef>
#include <cstdint>

#include "engine/cuda/cuda_check.hpp"

namespace palpate::cu {

/// Two buffers for keys and two for values; the sort alternates between them.
struct PairBuffers {
  std::uint32_t* keys[2];
  std::uint32_t* values[2];
};

/// Bytes of scratch for `count` pairs.
std::size_t cubSortScratchBytes(std::uint32_t count, unsigned keyBits);

/// Sorts the pairs in buffers 0 by the low `keyBits` bits of the key, stably; returns the index of the buffers with the
/// result. Submits only, so it can be recorded into a graph.
unsigned cubSort(const PairBuffers& pairs, std::uint32_t count, unsigned keyBits, void* scratch,
                 std::size_t scratchBytes, cudaStream_t stream);

}  // namespace palpate::cu
