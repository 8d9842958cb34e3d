// The gather without an index (thesis 4.3.1): every point is tested. Counts per chunk come first, so that each chunk
// knows its position in the patch and the patch keeps the order of the points.
#include "engine/cuda/gather_plan.cuh"
#include "engine/cuda/step_kernels.hpp"

namespace palpate::cu {

namespace {

// Offset of point `i` from the patch's centre, if it exists and is in reach.
struct Tested {
  bool near;
  vec3 relative;
};
__device__ Tested test(const StepArgs& args, const Gather& gather, uint i) {
  if (i >= args.cloud.slots) return {false, vec3(0.0f)};
  const vec3 relative = (xyz(loadPoint(args.cloud.positions, i)) - gather.hip) - gather.centre;
  return {glm::dot(relative, relative) < gather.reach * gather.reach, relative};
}

__device__ uint pointOf(uint chunk, uint turn) { return chunk * kBruteChunk + turn * kStepThreads + threadIdx.x; }

__global__ void __launch_bounds__(kStepThreads) countNear(const __grid_constant__ StepArgs args, ContactPose pose) {
  const Gather gather = gatherFor(args, pose);
  uint found = 0;
  for (uint turn = 0; turn < kBruteChunk / kStepThreads; ++turn)
    found += test(args, gather, pointOf(blockIdx.x, turn)).near;
  uint total;
  blockExclusiveScan(found, total);
  if (threadIdx.x == 0) args.chunkCounts[blockIdx.x] = total;
}

__global__ void __launch_bounds__(kStepThreads) fillNear(const __grid_constant__ StepArgs args, ContactPose pose) {
  const bool plans = blockIdx.x == 0;
  if (!plans && args.chunkCounts[blockIdx.x] == 0) return;
  Gather gather = gatherFor(args, pose);
  uint before = 0, total = 0;
  for (uint chunk = threadIdx.x; chunk < gridDim.x; chunk += kStepThreads) {
    const uint count = args.chunkCounts[chunk];
    before += chunk < blockIdx.x ? count : 0;
    total += count;
  }
  uint place, sum;
  blockExclusiveScan(before, place);
  blockExclusiveScan(total, sum);
  const uint stride = max(1u, sum / kMaxSlots + (sum % kMaxSlots != 0));
  if (plans && threadIdx.x == 0) {
    gather.slots = sum / stride + (sum % stride != 0);
    gather.thinned = stride > 1 ? 1 : 0;
    *args.gather = gather;
  }
  for (uint turn = 0; turn < kBruteChunk / kStepThreads; ++turn) {
    const uint i = pointOf(blockIdx.x, turn);
    const Tested tested = test(args, gather, i);
    uint found;
    const uint rank = place + blockExclusiveScan(tested.near ? 1 : 0, found);
    place += found;
    if (!tested.near || rank % stride != 0) continue;
    float4* const slot = reinterpret_cast<float4*>(args.slots) + 2 * (rank / stride);
    slot[0] = make_float4(tested.relative.x, tested.relative.y, tested.relative.z, 1.0f);
    slot[1] = loadPoint(args.cloud.normals, i);
  }
}

}  // namespace

void launchBruteGather(const StepArgs& args, const ContactPose& pose, cudaStream_t stream) {
  const std::uint32_t chunks = bruteChunks(args.cloud.slots);
  countNear<<<chunks, kStepThreads, 0, stream>>>(args, pose);
  fillNear<<<chunks, kStepThreads, 0, stream>>>(args, pose);
  checkLaunch("launching the brute force");
}

}  // namespace palpate::cu
