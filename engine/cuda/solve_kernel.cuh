// The end of every query with separate gather kernels; launched from the host and from the device.
#pragma once

#include "engine/cuda/step_args.hpp"

namespace palpate::cu {

__global__ void solveStep(const __grid_constant__ StepArgs args, shared::ContactPose pose);

}  // namespace palpate::cu
