// A kernel that stays on the GPU and answers poses as they come in through mapped host memory: no launch in a tick.
#include "engine/cuda/contact_step.cuh"
#include "engine/cuda/step_kernels.hpp"

namespace palpate::cu {

namespace {

// Without a letter for so long the kernel ends, and the host launches it again when it has one: a call that waits for
// the whole GPU (freeing memory, loading a kernel) is held up by that much and not for ever.
constexpr std::uint64_t kLongestIdle_ns = 50'000'000;

struct Sides {
  CloudView at[2];
};

__device__ std::uint64_t now_ns() {
  std::uint64_t time_ns;
  asm volatile("mov.u64 %0, %%globaltimer;" : "=l"(time_ns));
  return time_ns;
}

// Nothing that follows is read before this, by any thread behind the next barrier; what other kernels wrote before the
// host did is seen as well (PTX memory model, causality order).
__device__ uint readSequence(const Letter* letter) {
  uint sequence;
  asm volatile("ld.acquire.sys.u32 %0, [%1];" : "=r"(sequence) : "l"(&letter->sequence) : "memory");
  return sequence;
}

// Waits for a letter newer than `answered`; one that says stop when none comes.
__device__ Letter nextLetter(const Letter* box, uint answered) {
  const std::uint64_t began_ns = now_ns();
  Letter letter{};
  while ((letter.sequence = readSequence(box)) == answered) {
    if (now_ns() - began_ns < kLongestIdle_ns) continue;
    letter.stop = 1;
    return letter;
  }
  const volatile Letter& written = *box;
  letter.pose.hip = vec3(written.pose.hip.x, written.pose.hip.y, written.pose.hip.z);
  letter.pose.tick = written.pose.tick;
  letter.parity = written.parity;
  letter.stop = written.stop;
  return letter;
}

__global__ void __launch_bounds__(kStepThreads)
    residentStep(const __grid_constant__ StepArgs args, const __grid_constant__ Sides sides, uint answered) {
  __shared__ SharedPatch memory;
  __shared__ Letter letter;
  const std::uint64_t born_ns = now_ns();
  const long long born_clocks = clock64();
  for (;;) {
    long long began_clocks = 0;
    if (threadIdx.x == 0) {
      letter = nextLetter(args.letter, answered);
      began_clocks = clock64();
    }
    __syncthreads();
    if (letter.stop != 0) return;
    ContactStep step(args, sides.at[letter.parity & 1], memory, letter.pose);
    step.run();
    step.write();
    if (threadIdx.x == 0) {
      const long long now_clocks = clock64();
      args.answer->step_clocks = now_clocks - began_clocks;
      args.answer->alive_clocks = now_clocks - born_clocks;
      args.answer->alive_ns = now_ns() - born_ns;
    }
    publish(args, letter.pose.tick);
    answered = letter.sequence;
    __syncthreads();  // thread 0 writes the next letter over this one
  }
}

}  // namespace

void launchResident(const StepArgs& args, const CloudView (&sides)[2], std::uint32_t answered, cudaStream_t stream) {
  residentStep<<<1, kStepThreads, 0, stream>>>(args, Sides{{sides[0], sides[1]}}, answered);
  checkLaunch("launching the resident kernel");
}

}  // namespace palpate::cu
