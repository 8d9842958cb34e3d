// The CUDA back end as the programs see it, whether this palpate was built with it or not.
#pragma once

#include <span>

#include "apps/backend.hpp"

namespace palpate {

/// Names of the methods of the CUDA back end on the command line. The same in every build.
const std::vector<std::string>& cudaMethods();

/// Throws CudaError where there is no GPU that CUDA can use, and Error in a palpate that was built without CUDA.
std::unique_ptr<TouchBackend> makeCudaBackend(const Model& model, const TouchOptions& options,
                                              const std::string& method);

/// The GPU that CUDA takes.
std::string cudaMachine();

/// CUB's times as the peer of ours, us on the GPU: a build of the index, and a sort of (key, number) pairs.
std::vector<double> cubBuildTimes_us(const PointCloud& cloud, const HashGrid& grid, int repeat);
std::vector<double> cubSortTimes_us(std::span<const std::uint32_t> keys, unsigned bits, int repeat);

}  // namespace palpate
