// The launches that the query methods are made of. All of them submit only.
#pragma once

#include "engine/cuda/cuda_check.hpp"
#include "engine/cuda/step_args.hpp"

namespace palpate::cu {

/// Everything in one block; the pose stands in args.message.
void launchFused(const StepArgs& args, cudaStream_t stream);
/// Gathers into slots come before; this takes them over, moves the proxy and answers.
void launchSolve(const StepArgs& args, const shared::ContactPose& pose, cudaStream_t stream);

/// Tests every point (thesis 4.3.1).
void launchBruteGather(const StepArgs& args, const shared::ContactPose& pose, cudaStream_t stream);

/// Two steps (thesis 4.3.2): the plan of a gather with a report for the host, and the gather by as many rows of threads
/// as there are runs, each as long as the longest.
void launchPlan(const StepArgs& args, const shared::ContactPose& pose, cudaStream_t stream);
void launchFill(const StepArgs& args, const PlanReport& report, cudaStream_t stream);

/// The whole query by launches from the device: a grid for every bucket (thesis 4.3.3), or one grid for all of them.
void launchNaive(const StepArgs& args, const shared::ContactPose& pose, cudaStream_t stream);
void launchArray(const StepArgs& args, const shared::ContactPose& pose, cudaStream_t stream);
/// Room for one launch per cell of a gather. Once, before the two above.
void reserveDeviceLaunches();

/// A kernel that stays and answers messages until one says stop, or none has come for a while. `halves`: the cloud by
/// the message's parity; `answered`: sequence of the last message that has its answer.
void launchResident(const StepArgs& args, const shared::CloudView (&halves)[2], std::uint32_t answered,
                    cudaStream_t stream);

}  // namespace palpate::cu
