#include "engine/cuda/contact_step.cuh"
#include "engine/cuda/solve_kernel.cuh"
#include "engine/cuda/step_kernels.hpp"

namespace palpate::cu {

namespace {

__global__ void __launch_bounds__(kStepThreads) fusedStep(const __grid_constant__ StepArgs args) {
  __shared__ SharedPatch memory;
  __shared__ ContactPose pose;
  if (threadIdx.x == 0) pose = args.message->pose;  // one read over the bus, not one per warp
  __syncthreads();
  ContactStep step(args, args.cloud, memory, pose);
  step.run();
  step.write();
}

}  // namespace

__global__ void __launch_bounds__(kStepThreads) solveStep(const __grid_constant__ StepArgs args, ContactPose pose) {
  __shared__ SharedPatch memory;
  ContactStep step(args, args.cloud, memory, pose);
  step.takeOver(*args.gather);
  step.run();
  step.write();
}

void launchFused(const StepArgs& args, cudaStream_t stream) {
  fusedStep<<<1, kStepThreads, 0, stream>>>(args);
  checkLaunch("launching the fused step");
}

void launchSolve(const StepArgs& args, const ContactPose& pose, cudaStream_t stream) {
  solveStep<<<1, kStepThreads, 0, stream>>>(args, pose);
  checkLaunch("launching the end of a query");
}

}  // namespace palpate::cu
