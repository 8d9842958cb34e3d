// The launches used by the query methods. All of them submit only.
#pragma once

#include "engine/cuda/cuda_check.hpp"
#include "engine/cuda/step_args.hpp"

namespace palpate::cu {

/// The whole query in one block; the pose is in args.message.
void launchFused(const StepArgs& args, cudaStream_t stream);
/// After a gather into slots: takes its points over, moves the proxy and answers.
void launchSolve(const StepArgs& args, const shared::ContactPose& pose, cudaStream_t stream);

/// Tests every point (thesis 4.3.1).
void launchBruteGather(const StepArgs& args, const shared::ContactPose& pose, cudaStream_t stream);

/// Two steps (thesis 4.3.2): the plan of a gather with a report for the host, then the gather with one row of threads
/// per run, each as long as the longest.
void launchPlan(const StepArgs& args, const shared::ContactPose& pose, cudaStream_t stream);
void launchFill(const StepArgs& args, const PlanReport& report, cudaStream_t stream);

/// The whole query by launches from the device: one grid per bucket (thesis 4.3.3), or one grid for all of them.
void launchNaive(const StepArgs& args, const shared::ContactPose& pose, cudaStream_t stream);
void launchArray(const StepArgs& args, const shared::ContactPose& pose, cudaStream_t stream);
/// Reserves one launch per cell of a gather. Call once before the two above.
void reserveDeviceLaunches();

/// A resident kernel that answers messages until a stop message, or until none has arrived for a while. `halves`: the
/// cloud, indexed by the message's parity; `answered`: sequence of the last answered message.
void launchResident(const StepArgs& args, const shared::CloudView (&halves)[2], std::uint32_t answered,
                    cudaStream_t stream);

}  // namespace palpate::cu
