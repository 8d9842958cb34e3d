// The gather in two steps (thesis 4.3.2): the first counts the points of each bucket in the range of influence, the
// host reads the maximum, the second has a row of that many threads per bucket.
#include "engine/cuda/plan_runs.cuh"
#include "engine/cuda/step_kernels.hpp"

namespace palpate::cu {

namespace {

__global__ void __launch_bounds__(kStepThreads) planStep(const __grid_constant__ StepArgs args, ContactPose pose) {
  const Gather gather = planRuns(args, pose);
  if (threadIdx.x != 0) return;
  args.report->runs = gather.runs;
  args.report->longestRun = gather.longestRun;
  __threadfence_system();
  *const_cast<volatile std::uint32_t*>(&args.report->sequence) = pose.tick;
}

__global__ void __launch_bounds__(kStepThreads) fillRows(const __grid_constant__ StepArgs args) {
  const CellRun run = args.runs[blockIdx.y];
  const uint j = blockIdx.x * kStepThreads + threadIdx.x;
  if (j < run.taken) fillSlot(args, *args.gather, run, j);
}

}  // namespace

void launchPlan(const StepArgs& args, const ContactPose& pose, cudaStream_t stream) {
  planStep<<<1, kStepThreads, 0, stream>>>(args, pose);
  checkLaunch("launching the first step of a query");
}

void launchFill(const StepArgs& args, const PlanReport& report, cudaStream_t stream) {
  if (report.runs == 0) return;
  const dim3 blocks((report.longestRun + kStepThreads - 1) / kStepThreads, report.runs);
  fillRows<<<blocks, kStepThreads, 0, stream>>>(args);
  checkLaunch("launching the second step of a query");
}

}  // namespace palpate::cu
