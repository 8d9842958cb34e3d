// Checks of CUDA runtime calls. Does not include fmt, so that device code compiles quickly.
#pragma once

#include <cuda_runtime_api.h>

namespace palpate::cu {

/// Throws CudaError unless `status` is cudaSuccess. `what`: the operation, in words ("building the index").
void checkCuda(cudaError_t status, const char* what);

/// The same for the launches just made by this thread.
inline void checkLaunch(const char* what) { checkCuda(cudaGetLastError(), what); }

}  // namespace palpate::cu
