// The queries that launch from the device (thesis 4.3.3). On compute capability 9.0 a kernel cannot wait for its
// children: they are launched fire-and-forget, and the work after them is a tail launch of their parent.
#include <cuda_device_runtime_api.h>

#include "engine/cuda/plan_runs.cuh"
#include "engine/cuda/solve_kernel.cuh"
#include "engine/cuda/step_kernels.hpp"

namespace palpate::cu {

namespace {

constexpr uint kChildThreads = 128;

__global__ void __launch_bounds__(kChildThreads)
    fillOneRun(const __grid_constant__ StepArgs args, const __grid_constant__ Gather gather, CellRun run) {
  const uint j = blockIdx.x * kChildThreads + threadIdx.x;
  if (j < run.taken) fillSlot(args, gather, run, j);
}

__global__ void __launch_bounds__(kChildThreads) fillRunPerBlock(const __grid_constant__ StepArgs args) {
  const CellRun run = args.runs[blockIdx.x];
  for (uint j = threadIdx.x; j < run.taken; j += kChildThreads) fillSlot(args, *args.gather, run, j);
}

// The end of the query, after all children have completed; reports a refused launch to the host.
__device__ void solveAfterChildren(const StepArgs& args, const ContactPose& pose) {
  args.answer->launchError = cudaGetLastError();
  solveStep<<<1, kStepThreads, 0, cudaStreamTailLaunch>>>(args, pose);
}

// A single thread, as in the thesis. It iterates over each round of cells twice, since the number of a round's
// candidates determines which of them are visited.
__global__ void naiveParent(const __grid_constant__ StepArgs args, ContactPose pose) {
  Gather gather = gatherFor(args, pose);
  gather.box = boxAround(args.cloud, gather.hip, gather.centre, gather.reach);
  for (uint first = 0; first < gather.box.cells; first += kStepThreads) {
    const uint past = min(first + kStepThreads, gather.box.cells);
    uint total = 0;
    for (uint c = first; c < past; ++c) total += candidatesIn(rangeOfCell(args.cloud, gather.box, c));
    const uint stride = strideFor(total);
    uint start = 0;
    for (uint c = first; c < past; ++c) {
      const uint2 range = rangeOfCell(args.cloud, gather.box, c);
      const uint count = candidatesIn(range);
      const CellRun run = runOf(c, range.x, start, count, stride, gather.slots);
      start += count;
      if (run.taken == 0) continue;
      const uint blocks = (run.taken + kChildThreads - 1) / kChildThreads;
      fillOneRun<<<blocks, kChildThreads, 0, cudaStreamFireAndForget>>>(args, gather, run);
    }
    gather.slots += (total + stride - 1) / stride;
    gather.thinned |= stride > 1 ? 1 : 0;
  }
  *args.gather = gather;
  solveAfterChildren(args, pose);
}

__global__ void __launch_bounds__(kStepThreads) arrayParent(const __grid_constant__ StepArgs args, ContactPose pose) {
  const Gather gather = planRuns(args, pose);
  __threadfence();  // the children read the lists of all threads of this block
  __syncthreads();
  if (threadIdx.x != 0) return;
  if (gather.runs > 0) fillRunPerBlock<<<gather.runs, kChildThreads, 0, cudaStreamFireAndForget>>>(args);
  solveAfterChildren(args, pose);
}

}  // namespace

void reserveDeviceLaunches() {
  constexpr std::size_t kSpare = 64;
  checkCuda(cudaDeviceSetLimit(cudaLimitDevRuntimePendingLaunchCount, kPatchMaxCells + kSpare),
            "reserving launches from the device");
}

void launchNaive(const StepArgs& args, const ContactPose& pose, cudaStream_t stream) {
  naiveParent<<<1, 1, 0, stream>>>(args, pose);
  checkLaunch("launching a query with a grid per bucket");
}

void launchArray(const StepArgs& args, const ContactPose& pose, cudaStream_t stream) {
  arrayParent<<<1, kStepThreads, 0, stream>>>(args, pose);
  checkLaunch("launching a query with one grid for all buckets");
}

}  // namespace palpate::cu
