#pragma once

#include "engine/cuda/gather_plan.cuh"

namespace palpate::cu {

/// Lists the cells with candidates, in order, with their slots; one block. Writes the list and the gather to the
/// buffers; all threads return the same gather.
inline __device__ Gather planRuns(const StepArgs& args, const ContactPose& pose) {
  Gather gather = gatherFor(args, pose);
  gather.box = boxAround(args.cloud, gather.hip, gather.centre, gather.reach);
  for (uint first = 0; first < gather.box.cells; first += kStepThreads) {
    const uint cell = first + threadIdx.x;
    const uint2 range = rangeOfCell(args.cloud, gather.box, cell);
    const uint count = candidatesIn(range);
    uint total;
    const uint start = blockExclusiveScan(count, total);
    const uint stride = strideFor(total);
    const CellRun run = runOf(cell, range.x, start, count, stride, gather.slots);
    uint listed;
    const uint place = gather.runs + blockExclusiveScan(run.taken > 0 ? 1 : 0, listed);
    if (run.taken > 0) args.runs[place] = run;
    gather.runs += listed;
    gather.slots += (total + stride - 1) / stride;
    gather.longestRun = max(gather.longestRun, blockMax(run.taken));
    gather.thinned |= stride > 1 ? 1 : 0;
  }
  if (threadIdx.x == 0) *args.gather = gather;
  return gather;
}

}  // namespace palpate::cu
